#include "acquisition/virtual/world.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace lumifield::virtual_bench {

namespace {

/// The part of S a scan measures, and the largest shift of it before the camera.
constexpr double half_screen_mm = 150, screen_margin_mm = 8;

Vec2 half_view_mm(const Bench& bench) {
  Vec2 half(half_screen_mm, half_screen_mm);
  if (bench.stage_carries == StageCarries::slide) return half;
  half += half_grid_mm(bench) + Vec2(2, 2);
  half.x() += std::abs(bench.filter.passes.front().offset_mm.x());
  return half;
}

Sensor make_sensor(const std::string& pixel_format) {
  // 12 bits over a full well of 10 000 e⁻; Mono16 is the same analogue chain on a scale 16 times finer.
  const double scale = pixel_format == "Mono16" ? 16 : 1;
  Sensor sensor;
  sensor.black_level_dn = 64 * scale;
  sensor.gain_dn_per_e = 0.4 * scale;
  sensor.read_noise_e = 4;
  sensor.saturation_dn = pixel_format == "Mono16" ? 65535 : 4095;
  sensor.responsivity = {5e4};
  if (pixel_format == "BayerRG12") sensor.responsivity = {4e4, 5e4, 3.6e4};
  sensor.responsivity_date = "2026-01-01";
  sensor.responsivity_source = "virtual bench";
  return sensor;
}

Bench make_bench(const WorldOptions& options, const Lamp& lamp) {
  Bench bench;
  bench.name = "virtual bench, " + options.lamp;
  bench.camera.pixel_format = options.pixel_format;
  bench.stage_carries = options.carries;
  bench.lamp_size_mm = lamp.size_mm;
  bench.separation_mm = plane_separation_mm;
  bench.filter.basis = options.basis;
  bench.filter.spacing_mm = options.spacing_mm;
  bench.filter.window = options.window;
  bench.filter.change = options.change;
  lay_out_slide(bench);
  bench.camera_model =
      place_camera(options.width_px, options.height_px, plane_separation_mm, half_view_mm(bench), options.optics);
  bench.sensor = make_sensor(options.pixel_format);
  return bench;
}

std::vector<Slide> make_slides(const FilterSlide& filter) {
  std::vector<Slide> slides{Slide(filter)};
  for (std::size_t pass = 0; pass < filter.passes.size(); ++pass) slides.push_back(Slide::of_pass(filter, pass));
  return slides;
}

}  // namespace

World::World(const WorldOptions& options)
    : lamp_(*make_lamp(options.lamp)),
      bench_(make_bench(options, lamp_)),
      slides_(make_slides(bench_.filter)),
      no_slide_(Slide::none(bench_.filter)),
      grid_(ScreenGrid::covering(half_view_mm(bench_) + Vec2::Constant(screen_margin_mm), 0.5)),
      pinhole_(make_lens_map(with_optics(bench_.camera_model, false), plane_separation_mm)),
      lens_(make_lens_map(with_optics(bench_.camera_model, true), plane_separation_mm)),
      photosites_(bench_.sensor, options.width_px, options.height_px, options.seed),
      noise_(options.noise),
      optics_(options.optics),
      slide_(options.change == PassChange::by_operator ? 1 : 0),
      worker_([this](std::stop_token stop) { work(stop); }) {}

World::Frame World::render(const View& view) const {
  const bool bayer = bench_.sensor.responsivity.size() == 3;
  std::vector<Eigen::Array3d> bands{mono_weights};
  if (bayer) bands = {Eigen::Array3d(1, 0, 0), Eigen::Array3d(0, 1, 0), Eigen::Array3d(0, 0, 1)};
  const Vec2 stage_mm = 1e-3 * Vec2(static_cast<double>(view.x_um), static_cast<double>(view.y_um));
  const std::vector<Plane> screen =
      screen_irradiance(lamp_, view.filter ? slides_[view.slide] : no_slide_, bench_, grid_, stage_mm, bands);

  const LensMap& lens = view.optics ? lens_ : pinhole_;
  auto rate = std::make_shared<std::vector<float>>(lens.illumination.size());
  for (std::size_t band = 0; band < bands.size(); ++band) {
    const Plane seen = photograph(screen[band], grid_, lens, view.optics ? 0.5 : 0);
    const float responsivity = static_cast<float>(bench_.sensor.responsivity[band]);
    std::size_t p = 0;
    for (int j = 0; j < lens.height_px; ++j)
      for (int i = 0; i < lens.width_px; ++i, ++p)
        // RGGB: even row and column R, odd row and column B.
        if (!bayer || static_cast<std::size_t>(i % 2 + j % 2) == band)
          (*rate)[p] = responsivity * lens.illumination[p] * seen.data()[p];
  }
  return rate;
}

World::View World::view_of(const Vec2& stage_mm) const {
  return {std::llround(stage_mm.x() * 1e3), std::llround(stage_mm.y() * 1e3), optics_, filter_, slide_};
}

World::Frame World::find(const View& view) const {
  for (const auto& [seen, frame] : frames_)
    if (seen == view) return frame;
  return nullptr;
}

void World::want(const View& view) {
  if (find(view) || std::find(wanted_.begin(), wanted_.end(), view) != wanted_.end()) return;
  constexpr std::size_t longest_queue = 4;
  if (wanted_.size() == longest_queue) wanted_.pop_front();
  wanted_.push_back(view);
  changed_.notify_all();
}

void World::work(std::stop_token stop) {
  constexpr std::size_t kept = 8;
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !wanted_.empty(); })) {
    const View view = wanted_.front();
    lock.unlock();
    Frame frame = render(view);
    lock.lock();
    std::erase(wanted_, view);
    frames_.emplace_back(view, std::move(frame));
    if (frames_.size() > kept) frames_.pop_front();
    changed_.notify_all();
  }
}

std::pair<World::View, World::Frame> World::wait(const Vec2& stage_mm) {
  std::unique_lock lock(mutex_);
  const View view = view_of(stage_mm);
  Frame frame;
  while (!(frame = find(view))) {
    want(view);
    changed_.wait(lock);
  }
  return {view, frame};
}

Status check(const WorldOptions& options) {
  const auto refuse = [](const std::string& what, const std::string& remedy) {
    return fail(what, "virtual bench", remedy);
  };
  if (!make_lamp(options.lamp)) return refuse("no lamp \"" + options.lamp + "\"", "use bike, headlight or led-array");
  const std::string& format = options.pixel_format;
  if (format != "Mono12" && format != "Mono16" && format != "BayerRG12")
    return refuse("no pixel format \"" + format + "\"", "use Mono12, Mono16 or BayerRG12");
  const bool spacing_fits = (options.spacing_mm.array() >= 1).all() && (options.spacing_mm.array() <= 60).all();
  if (!spacing_fits) return refuse("cell spacing outside 1 … 60 mm", "use about 7.5 mm");
  const int support = Basis(options.basis).overlap();
  if (options.window < support || options.window > 12)
    return refuse("dual window outside " + std::to_string(support) + " … 12 spacings", "use the basis' natural window");
  if (options.width_px < 64 || options.height_px < 64 || options.width_px > 4096 || options.height_px > 4096)
    return refuse("sensor size outside 64 … 4096 px", "use 1024 by 768");
  return {};
}

Result<std::unique_ptr<World>> World::create(const WorldOptions& options) {
  if (Status status = check(options); !status) return tl::unexpected(status.error());
  return std::unique_ptr<World>(new World(options));
}

void World::prepare(const Vec2& stage_mm) {
  const std::scoped_lock lock(mutex_);
  want(view_of(stage_mm));
}

void World::expose(const Vec2& stage_mm, double exposure_s, double gain_db, int width_px, int height_px,
                   int offset_x_px, int offset_y_px, std::span<std::uint16_t> dn) {
  const auto [view, frame] = wait(stage_mm);
  Photosites::Exposure exposure{{view.x_um, view.y_um}, exposure_s, gain_db, true, 1};
  exposure.light = light();
  {
    const std::scoped_lock lock(mutex_);
    exposure.noise = noise_;
  }
  // Photosites of the region that the sensor has; others read 0.
  std::fill(dn.begin(), dn.end(), std::uint16_t{0});
  if (offset_x_px < 0 || offset_y_px < 0) return;
  const int columns = std::min(width_px, lens_.width_px - offset_x_px);
  const int rows = std::min(height_px, lens_.height_px - offset_y_px);
  for (int j = 0; columns > 0 && j < rows && static_cast<std::size_t>(j + 1) * width_px <= dn.size(); ++j) {
    const std::size_t first = static_cast<std::size_t>(j + offset_y_px) * lens_.width_px + offset_x_px;
    photosites_.expose(exposure, first, {frame->data() + first, static_cast<std::size_t>(columns)},
                       dn.subspan(static_cast<std::size_t>(j) * width_px, columns));
  }
}

double World::light() {
  const auto since = [now = Clock::now()](Clock::time_point then) {
    return std::chrono::duration<double>(now - then).count();
  };
  const std::scoped_lock lock(mutex_);
  const double drifted = 1 + drift_per_hour_ * since(drift_start_) / 3600;
  return std::max(0.0, drifted * (1 + warm_up_ * std::exp(-since(switched_on_) / warm_up_s_)));
}

Status World::set(const std::string& knob, double value) {
  const std::scoped_lock lock(mutex_);
  const std::map<std::string, bool*> switches{{"noise", &noise_}, {"optics", &optics_}, {"filter", &filter_}};
  if (const auto found = switches.find(knob); found != switches.end() && (value == 0 || value == 1)) {
    *found->second = value == 1;
  } else if (knob == "slide" && value >= 0 && value < static_cast<double>(slides_.size()) &&
             value == std::floor(value)) {
    slide_ = static_cast<std::size_t>(value);
  } else if (knob == "lamp_drift" && std::isfinite(value)) {
    drift_per_hour_ = value;
    drift_start_ = Clock::now();
  } else if (knob == "lamp_warm_up" && value >= -1 && std::isfinite(value)) {
    warm_up_ = value;
    switched_on_ = Clock::now();
  } else if (knob == "lamp_warm_up_s" && value > 0 && std::isfinite(value)) {
    warm_up_s_ = value;
    switched_on_ = Clock::now();
  } else {
    return fail("no knob \"" + knob + "\" that takes " + std::to_string(value), "virtual bench",
                "use noise, optics or filter 0|1, slide 0|1|2, lamp_drift <relative change per hour>, lamp_warm_up "
                "<relative excess at first, -1 or more> or lamp_warm_up_s <its time constant, s>");
  }
  return {};
}

}  // namespace lumifield::virtual_bench
