#include "calibration/develop.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <list>
#include <set>

#include "calibration/bracket_merge.h"
#include "calibration/lens_model.h"
#include "calibration/quality.h"
#include "calibration/raw_checks.h"
#include "calibration/screen_resampler.h"

namespace lumifield {
namespace {

/// A pixel of S of which footprints cover less than this is not seen.
constexpr double least_coverage = 0.5;

/// Every displacement that the plan asks for.
std::vector<Vec2> planned_displacements_mm(const Bench& bench, const Sampling& sampling) {
  if (bench.stage_carries == StageCarries::slide) return {Vec2::Zero()};
  std::vector<Vec2> all;
  for (const FilterPass& pass : bench.filter.passes)
    for (int m = 0; m < sampling.cells(); ++m)
      all.push_back(bench.stage_to_luminaire.linear * pass.offset_mm - sampling.cell_center_mm(sampling.index(m)));
  return all;
}

std::string in_mm(const Vec2& p) {
  char text[80];
  std::snprintf(text, sizeof text, "(%.1f, %.1f) mm", p.x(), p.y());
  return text;
}

/// How far outside the image the camera sees the border of S, px; infinite where it doesn't see it at all.
struct Shortfall {
  double px = 0;
  Vec2 point_mm{0, 0}, displacement_mm{0, 0};
};

Shortfall worst_shortfall(const Bench& bench, const LensModel& lens, const LuminaireGeometry& geometry) {
  const CameraModel& camera = bench.camera_model;
  const double rim = pattern_of(bench.camera.pixel_format) == SensorPattern::mono ? 0.5 : 0;
  const Vec2 size(camera.width_px - 1 + rim, camera.height_px - 1 + rim);
  const Vec2 low = geometry.measurement.corner_mm(), extent = 2 * (geometry.measurement.center_mm - low);
  constexpr int steps = 32;

  Shortfall worst;
  for (const Vec2& d : planned_displacements_mm(bench, geometry.sampling)) {
    for (int side = 0; side < 4; ++side) {
      for (int k = 0; k < steps; ++k) {
        const double along = static_cast<double>(side < 2 ? k : k + 1) / steps, across = side % 2;
        const Vec2 share = side < 2 ? Vec2(along, across) : Vec2(across, along);
        const Vec2 s = low + extent.cwiseProduct(share);
        const auto pixel = lens.project(Vec3(s.x() + d.x(), s.y() + d.y(), bench.separation_mm));
        const double px =
            pixel ? std::max({-rim - pixel->x(), -rim - pixel->y(), pixel->x() - size.x(), pixel->y() - size.y()})
                  : std::numeric_limits<double>::infinity();
        if (px > worst.px) worst = {px, s, d};
      }
    }
  }
  return worst;
}

Status check_camera_sees_screen(const Bench& bench, const LensModel& lens, const LuminaireGeometry& geometry) {
  const Shortfall worst = worst_shortfall(bench, lens, geometry);
  if (worst.px <= 1e-6) return {};
  const std::string how = std::isfinite(worst.px)
                              ? std::to_string(static_cast<int>(std::ceil(worst.px))) + " px outside its image"
                              : "beyond its field of view";
  const std::string lamp =
      bench.stage_carries == StageCarries::lamp ? " with the lamp displaced by " + in_mm(worst.displacement_mm) : "";
  return fail("the camera doesn't see all of S: " + in_mm(worst.point_mm) + " lies " + how + lamp, "plan.measurement",
              "measure a smaller part of S, or place the camera so that it sees all of it");
}

/// (W/m²)/(e⁻/s) / (a_x a_y) of every photosite: 1/(responsivity · V · a_x a_y).
std::vector<float> photosite_factors(const Bench& bench, const LensModel& lens) {
  const CameraModel& camera = bench.camera_model;
  const SensorPattern pattern = pattern_of(bench.camera.pixel_format);
  const double cell_area = bench.filter.spacing_mm.prod();
  std::vector<float> factor;
  factor.reserve(static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px));
  for (int j = 0; j < camera.height_px; ++j) {
    Vec2 start = Vec2::Zero();
    for (int i = 0; i < camera.width_px; ++i) {
      const auto ray = lens.undistort(Vec2(i, j), start);
      start = ray.value_or(Vec2::Zero());
      const double v = ray ? lens.relative_illumination(*ray) : 0;
      const double responsivity = bench.sensor.responsivity[static_cast<std::size_t>(photosite_channel(pattern, i, j))];
      factor.push_back(v > 0 ? static_cast<float>(1 / (responsivity * v * cell_area)) : 0);
    }
  }
  return factor;
}

}  // namespace

LuminaireGeometry luminaire_geometry(const Bench& bench, const Plan& plan) {
  LuminaireGeometry geometry;
  geometry.planes.separation_mm = bench.separation_mm;
  geometry.sampling = {bench.filter.basis, bench.filter.spacing_mm, plan.columns, plan.rows, plan.center_mm};
  geometry.measurement = plan.measurement;
  if (pattern_of(bench.camera.pixel_format) == SensorPattern::mono)
    geometry.channels = {"Y"};
  else
    geometry.channels = {"R", "G", "B"};
  const Sensor& sensor = bench.sensor;
  const bool calibrated =
      !sensor.responsivity.empty() && !sensor.responsivity_date.empty() && !sensor.responsivity_source.empty();
  geometry.quantity = calibrated ? Quantity::radiance : Quantity::relative;
  return geometry;
}

struct Developer::Impl {
  Bench bench;
  Plan plan;
  LuminaireGeometry geometry;
  SensorPattern pattern = SensorPattern::mono;
  ScreenLattice lattice;
  std::vector<float> factor;
  std::vector<PhotositeSignal> signal;
  std::list<DarkModel> darks;  ///< of the cell developed last

  // Of the last displacement
  std::optional<Vec2> displaced_mm;
  std::vector<OverlapWeights> weights;
  std::vector<RowSpan> rows;

  Status weigh(const Vec2& displacement);
  Status load_darks(const RawCell& raw);
  const DarkModel* model_of(const std::shared_ptr<const DarkSet>& set) const;
  void add_passes(std::span<const WeightedBracket> passes, const DarkModel* dark, CellImage& image,
                  ScreenFaults& faults);
  Result<CellImage> develop(const RawCell& raw);
};

/// Makes the weights of a displacement, unless they are those at hand.
Status Developer::Impl::weigh(const Vec2& displacement) {
  if (displaced_mm && *displaced_mm == displacement) return {};
  displaced_mm.reset();
  weights.clear();
  for (int c = 0; c < static_cast<int>(geometry.channels.size()); ++c) {
    weights.push_back(overlap_weights(lattice, {pattern, c}, geometry.measurement, displacement));
    if (weights.back().smallest_coverage < least_coverage)
      return fail("the camera doesn't see all of S with the lamp displaced by " + in_mm(displacement), "camera_model",
                  "check the stage reading and the camera's place");
  }
  rows = photosite_rows(weights, bench.camera_model.width_px, bench.camera_model.height_px);
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (int i = rows[j].begin; i < rows[j].end; ++i)
      if (factor[j * static_cast<std::size_t>(bench.camera_model.width_px) + static_cast<std::size_t>(i)] == 0)
        return fail(
            "the relative illumination falls to 0 at pixel (" + std::to_string(i) + ", " + std::to_string(j) + ")",
            "camera_model.vignetting", "calibrate the camera again");
  displaced_mm = displacement;
  return {};
}

/// Null where there is none.
const DarkModel* Developer::Impl::model_of(const std::shared_ptr<const DarkSet>& set) const {
  const auto found = std::ranges::find(darks, set, &DarkModel::set);
  return found == darks.end() ? nullptr : &*found;
}

/// Keeps the dark models of a block of cells.
Status Developer::Impl::load_darks(const RawCell& raw) {
  std::set<std::shared_ptr<const DarkSet>> needed{raw.dark};
  for (const RawPass& pass : raw.passes) needed.insert(pass.dark);
  std::erase_if(darks, [&](const DarkModel& dark) { return !needed.contains(dark.set()); });
  for (const auto& set : needed)
    if (set && !model_of(set)) darks.emplace_back(set, bench.sensor);
  for (const RawPass& pass : raw.passes)
    if (const DarkModel* dark = model_of(pass.dark ? pass.dark : raw.dark))
      if (Status ok = check_dark_exposures(pass, *dark); !ok) return ok;
  return {};
}

/// Merges passes that see S in the same place, resamples their sum and adds it.
void Developer::Impl::add_passes(std::span<const WeightedBracket> passes, const DarkModel* dark, CellImage& image,
                                 ScreenFaults& faults) {
  merge_brackets(passes, dark, bench.sensor, factor, rows, signal);
  for (std::size_t c = 0; c < weights.size(); ++c) {
    const ScreenChannel channel = resample(weights[c], signal);
    const std::size_t offset = c * image.plane();
    for (std::size_t p = 0; p < image.plane(); ++p) {
      image.value[offset + p] += channel.value[p];
      image.variance[offset + p] += channel.variance[p];
      faults.valid_share[offset + p] = std::min(faults.valid_share[offset + p], channel.valid_share[p]);
      faults.electrons[offset + p] += channel.electrons[p];
    }
  }
}

Result<CellImage> Developer::Impl::develop(const RawCell& raw) {
  if (auto ok = check_raw(raw, bench, geometry); !ok) return tl::unexpected(ok.error());
  if (auto ok = load_darks(raw); !ok) return fail_in("cell " + to_string(raw.cell), ok.error());

  // Start from nothing
  CellImage image;
  image.width_px = geometry.measurement.width_px;
  image.height_px = geometry.measurement.height_px;
  image.channels = static_cast<int>(geometry.channels.size());
  const std::size_t values = image.plane() * geometry.channels.size();
  image.value.assign(values, 0);
  image.variance.assign(values, 0);
  ScreenFaults faults{std::vector<float>(values, 1), std::vector<float>(values, 0)};

  // Add the passes: together where they see S in the same place, else one by one
  const DarkModel* dark = model_of(raw.dark);
  std::vector<WeightedBracket> passes;
  for (std::size_t p = 0; p < raw.passes.size(); ++p) {
    passes.push_back({&raw.passes[p].bracket, bench.filter.passes[p].scale, model_of(raw.passes[p].dark)});
    if (bench.stage_carries == StageCarries::slide && p + 1 < raw.passes.size()) continue;
    if (auto ok = weigh(lamp_displacement_mm(bench, raw.passes[p].stage_mm)); !ok)
      return fail_in("cell " + to_string(raw.cell), ok.error());
    add_passes(passes, dark, image, faults);
    passes.clear();
  }

  const double dark_dn = dark ? dark->mean_dn() : std::numeric_limits<double>::quiet_NaN();
  image.quality = judge(image, faults, raw, dark_dn, bench, plan);
  return image;
}

Developer::Developer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Developer::~Developer() = default;
Developer::Developer(Developer&&) noexcept = default;
Developer& Developer::operator=(Developer&&) noexcept = default;

Result<Developer> Developer::create(const Bench& bench, const Plan& plan) {
  if (auto ok = check_bench(bench, plan); !ok) return tl::unexpected(ok.error());
  const LensModel lens(bench.camera_model);
  auto impl = std::make_unique<Impl>();
  impl->bench = bench;
  impl->plan = plan;
  impl->geometry = luminaire_geometry(bench, plan);
  if (auto ok = check_camera_sees_screen(bench, lens, impl->geometry); !ok) return tl::unexpected(ok.error());

  impl->pattern = pattern_of(bench.camera.pixel_format);
  impl->lattice = trace_lattice(lens, bench.camera_model, impl->pattern, bench.separation_mm);
  impl->factor = photosite_factors(bench, lens);
  impl->signal.resize(impl->factor.size());
  const Vec2 first = planned_displacements_mm(bench, impl->geometry.sampling).front();
  if (auto ok = impl->weigh(first); !ok) return tl::unexpected(ok.error());
  return Developer(std::move(impl));
}

const LuminaireGeometry& Developer::geometry() const { return impl_->geometry; }

Result<CellImage> Developer::develop(const RawCell& raw) { return impl_->develop(raw); }

}  // namespace lumifield
