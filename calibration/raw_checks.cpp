#include "calibration/raw_checks.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lumifield {
namespace {

constexpr double most_photosites = 1 << 25, most_pixels = 1 << 24;

bool all_finite(std::initializer_list<double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

Status check_camera_model(const CameraModel& m) {
  const char* where = "camera_model";
  if (m.width_px < 2 || m.height_px < 2 || static_cast<double>(m.width_px) * m.height_px > most_photosites)
    return fail("a sensor of " + std::to_string(m.width_px) + "×" + std::to_string(m.height_px) + " px", where,
                "give 2×2 px up to 32 Mpx");
  if (!all_finite({m.fx, m.fy, m.cx, m.cy}) || !(m.fx > 0 && m.fy > 0) ||
      !std::all_of(m.distortion.begin(), m.distortion.end(), [](double v) { return std::isfinite(v); }) ||
      !std::all_of(m.vignetting.begin(), m.vignetting.end(), [](double v) { return std::isfinite(v); }))
    return fail("fx and fy must be positive and all coefficients finite", where, "calibrate the camera again");
  const Eigen::Matrix3d r = m.pose.topLeftCorner<3, 3>();
  const double defect = (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!m.pose.allFinite() || !(defect < 1e-4) || !(r.determinant() > 0))
    return fail("the pose is not a rotation and a translation", std::string(where) + ".pose",
                "calibrate the camera again");
  return {};
}

Status check_sensor(const Sensor& s) {
  const char* where = "sensor";
  if (!all_finite({s.black_level_dn, s.gain_dn_per_e, s.read_noise_e, s.saturation_dn}) || !(s.gain_dn_per_e > 0) ||
      s.read_noise_e < 0 || !(s.saturation_dn > s.black_level_dn))
    return fail("gain must be positive, read noise not negative, saturation above the black level", where,
                "calibrate the sensor again");
  return {};
}

Status check_screen(const Bench& bench, const Plan& plan) {
  const Measurement& m = plan.measurement;
  if (m.width_px < 1 || m.height_px < 1 || static_cast<double>(m.width_px) * m.height_px > most_pixels ||
      !(m.pixel_mm.minCoeff() > 0) || !m.pixel_mm.allFinite() || !m.center_mm.allFinite())
    return fail("an image on S needs positive pixels, 1×1 up to 16 Mpx", "plan.measurement", "correct the plan");
  if (!(bench.separation_mm > 0) || !std::isfinite(bench.separation_mm))
    return fail("the separation of the planes must be positive", "planes.separation_mm", "correct the bench file");
  if (plan.columns < 1 || plan.rows < 1 || static_cast<double>(plan.columns) * plan.rows > 1e6)
    return fail("a grid of " + std::to_string(plan.columns) + "×" + std::to_string(plan.rows) + " cells", "plan",
                "give 1 to a million cells");
  return {};
}

Status check_filter(const FilterSlide& filter) {
  if (!(filter.spacing_mm.minCoeff() > 0) || !filter.spacing_mm.allFinite())
    return fail("the spacing must be positive", "filter.spacing_mm", "correct the bench file");
  if (filter.passes.empty()) return fail("no pass", "filter.passes", "name at least one filter");
  for (const FilterPass& pass : filter.passes)
    if (!std::isfinite(pass.scale) || pass.scale == 0 || !pass.offset_mm.allFinite())
      return fail("scale must be finite and not 0, offset finite", "filter.passes: " + pass.name,
                  "correct the bench file");
  return {};
}

Status check_frame(const RawImage& frame, const Bench& bench, const std::string& where) {
  const CameraModel& m = bench.camera_model;
  if (frame.width_px != m.width_px || frame.height_px != m.height_px ||
      frame.dn.size() != static_cast<std::size_t>(m.width_px) * static_cast<std::size_t>(m.height_px))
    return fail("a frame of " + std::to_string(frame.width_px) + "×" + std::to_string(frame.height_px) + " px with " +
                    std::to_string(frame.dn.size()) + " values, the camera model has " + std::to_string(m.width_px) +
                    "×" + std::to_string(m.height_px),
                where, "set the camera's full region, or calibrate it at this size");
  if (frame.pattern != pattern_of(bench.camera.pixel_format))
    return fail("the frame's colour pattern is not that of " + bench.camera.pixel_format, where,
                "correct camera.pixel_format in the bench file");
  if (frame.bits < 1 || frame.bits > 16 || bench.sensor.saturation_dn > (1 << frame.bits) - 1)
    return fail("saturation at " + std::to_string(bench.sensor.saturation_dn) + " DN can't be seen in " +
                    std::to_string(frame.bits) + " bits",
                where, "correct sensor.saturation_dn or camera.pixel_format in the bench file");
  if (!(frame.exposure_s > 0) || !std::isfinite(frame.exposure_s) || !std::isfinite(frame.gain))
    return fail("exposure must be positive and gain finite", where, "check what the camera reports");
  return {};
}

Status check_bracket(const Bracket& bracket, const Bench& bench, const std::string& where) {
  if (bracket.empty()) return fail("no exposure", where, "take the cell again");
  for (std::size_t k = 0; k < bracket.size(); ++k) {
    if (auto ok = check_frame(bracket[k], bench, where + ", exposure " + std::to_string(k)); !ok) return ok;
    if (k > 0 && bracket[k].exposure_s < bracket[k - 1].exposure_s)
      return fail("the exposures don't ascend", where, "order them by exposure time");
  }
  return {};
}

Status check_dark_set(const std::shared_ptr<const DarkSet>& dark, const Bench& bench, const std::string& where) {
  return dark ? check_bracket(dark->bracket, bench, where + ", dark set of block " + std::to_string(dark->block))
              : Status{};
}

}  // namespace

SensorPattern pattern_of(std::string_view pixel_format) {
  if (pixel_format.starts_with("BayerRG")) return SensorPattern::rggb;
  if (pixel_format == "RGB8" || pixel_format == "BGR8") return SensorPattern::rggb;
  if (pixel_format.starts_with("BayerGR")) return SensorPattern::grbg;
  if (pixel_format.starts_with("BayerGB")) return SensorPattern::gbrg;
  if (pixel_format.starts_with("BayerBG")) return SensorPattern::bggr;
  return SensorPattern::mono;
}

Status check_bench(const Bench& bench, const Plan& plan) {
  if (auto ok = check_camera_model(bench.camera_model); !ok) return ok;
  if (auto ok = check_sensor(bench.sensor); !ok) return ok;
  if (auto ok = check_screen(bench, plan); !ok) return ok;
  if (auto ok = check_filter(bench.filter); !ok) return ok;

  const std::size_t channels = pattern_of(bench.camera.pixel_format) == SensorPattern::mono ? 1 : 3;
  const std::vector<double>& responsivity = bench.sensor.responsivity;
  if (responsivity.size() != channels)
    return fail(std::to_string(responsivity.size()) + " responsivities for the " + std::to_string(channels) +
                    " channel(s) of " + bench.camera.pixel_format,
                "sensor.responsivity", "give one value per channel");
  if (!std::all_of(responsivity.begin(), responsivity.end(), [](double r) { return r > 0 && std::isfinite(r); }))
    return fail("must be positive", "sensor.responsivity", "calibrate the sensor again");
  return {};
}

Status check_raw(const RawCell& raw, const Bench& bench, const LuminaireGeometry& geometry) {
  const std::string where = "cell " + to_string(raw.cell);
  if (!geometry.sampling.contains(raw.cell)) return fail("outside the grid", where, "check the plan");
  const std::vector<FilterPass>& passes = bench.filter.passes;
  if (raw.passes.size() != passes.size())
    return fail(std::to_string(raw.passes.size()) + " passes, the bench has " + std::to_string(passes.size()), where,
                "take the cell again");
  for (std::size_t p = 0; p < passes.size(); ++p) {
    const RawPass& pass = raw.passes[p];
    if (pass.name != passes[p].name)
      return fail("pass " + std::to_string(p) + " is \"" + pass.name + "\", the bench has \"" + passes[p].name + "\"",
                  where, "take the passes in the bench's order");
    if (!pass.stage_mm.allFinite()) return fail("the stage reading is not finite", where, "check the stage");
    if (auto ok = check_bracket(pass.bracket, bench, where + ", pass " + pass.name); !ok) return ok;
    if (auto ok = check_dark_set(pass.dark, bench, where); !ok) return ok;
  }
  return check_dark_set(raw.dark, bench, where);
}

Status check_dark_exposures(const RawPass& pass, const DarkModel& dark) {
  for (const RawImage& frame : pass.bracket)
    if (!dark.match(frame))
      return fail(
          "no dark exposure of " + std::to_string(frame.exposure_s) + " s at a gain of " + std::to_string(frame.gain),
          "dark set of block " + std::to_string(dark.set()->block), "take the dark set with the exposures of the plan");
  return {};
}

}  // namespace lumifield
