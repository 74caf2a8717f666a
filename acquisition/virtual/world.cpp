#include "acquisition/virtual/world.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "acquisition/virtual/photosites.h"
#include "acquisition/virtual/screen.h"

namespace lumifield::virtual_bench {

namespace {

using Clock = std::chrono::steady_clock;

/// The part of S a scan measures, and the largest shift of it before the camera.
constexpr double kHalfScreenMm = 150, kScreenMarginMm = 8;

Vec2 half_view_mm(const Bench& bench) {
  Vec2 half(kHalfScreenMm, kHalfScreenMm);
  if (bench.stage_carries == StageCarries::slide) return half;
  for (int axis = 0; axis < 2; ++axis) {
    const double a = bench.filter.spacing_mm[axis];
    half[axis] += (cells_needed(bench.lamp_size_mm[axis], a, bench.filter.window) - 1) * a / 2 + 2;
  }
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
  bench.separation_mm = kSeparationMm;
  bench.filter.basis = options.basis;
  bench.filter.spacing_mm = options.spacing_mm;
  bench.filter.window = options.window;
  lay_out_slide(bench);
  bench.camera_model =
      place_camera(options.width_px, options.height_px, kSeparationMm, half_view_mm(bench), options.optics);
  bench.sensor = make_sensor(options.pixel_format);
  return bench;
}

/// A stage position in steps of 1 µm.
using Position = std::array<std::int64_t, 2>;
Position position_of(const Vec2& stage_mm) {
  return {std::llround(stage_mm.x() * 1e3), std::llround(stage_mm.y() * 1e3)};
}

/// Electrons per second of every pixel.
using Frame = std::shared_ptr<const std::vector<float>>;

}  // namespace

struct World::Impl {
  explicit Impl(const WorldOptions& given)
      : options(given),
        lamp(*make_lamp(given.lamp)),
        bench(make_bench(given, lamp)),
        slide(bench.filter),
        grid(ScreenGrid::covering(half_view_mm(bench) + Vec2::Constant(kScreenMarginMm), 0.5)),
        lens(make_lens_map(bench.camera_model, kSeparationMm)),
        photosites(bench.sensor, static_cast<int>(bench.sensor.saturation_dn), given.width_px, given.height_px,
                   given.seed),
        noise(given.noise),
        worker([this](std::stop_token stop) { work(stop); }) {}

  Frame render(const Position& position) const;
  void work(std::stop_token stop);
  Frame find(const Position& position) const;
  void want(const Position& position);
  Frame wait(const Position& position);
  double light() const;

  const WorldOptions options;
  const Lamp lamp;
  const Bench bench;
  const Slide slide;
  const ScreenGrid grid;
  const LensMap lens;
  const Photosites photosites;

  mutable std::mutex mutex;
  std::condition_variable_any changed;
  std::deque<Position> wanted;
  std::deque<std::pair<Position, Frame>> frames;
  bool noise;
  double drift_per_hour = 0;
  Clock::time_point drift_start = Clock::now();
  std::jthread worker;
};

Frame World::Impl::render(const Position& position) const {
  const bool bayer = bench.sensor.responsivity.size() == 3;
  std::vector<Eigen::Array3d> bands{kMonoWeights};
  if (bayer) bands = {Eigen::Array3d(1, 0, 0), Eigen::Array3d(0, 1, 0), Eigen::Array3d(0, 0, 1)};
  const Vec2 stage_mm(static_cast<double>(position[0]) * 1e-3, static_cast<double>(position[1]) * 1e-3);
  const std::vector<Plane> screen = screen_irradiance(lamp, slide, bench, grid, stage_mm, bands);

  auto rate = std::make_shared<std::vector<float>>(lens.illumination.size());
  for (std::size_t band = 0; band < bands.size(); ++band) {
    const Plane seen = photograph(screen[band], grid, lens, options.optics ? 0.5 : 0);
    const float responsivity = static_cast<float>(bench.sensor.responsivity[band]);
    std::size_t p = 0;
    for (int j = 0; j < lens.height_px; ++j)
      for (int i = 0; i < lens.width_px; ++i, ++p)
        // RGGB: even row and column R, odd row and column B.
        if (!bayer || static_cast<std::size_t>(i % 2 + j % 2) == band)
          (*rate)[p] = responsivity * lens.illumination[p] * seen.data()[p];
  }
  return rate;
}

Frame World::Impl::find(const Position& position) const {
  for (const auto& [at, frame] : frames)
    if (at == position) return frame;
  return nullptr;
}

void World::Impl::want(const Position& position) {
  if (find(position) || std::find(wanted.begin(), wanted.end(), position) != wanted.end()) return;
  constexpr std::size_t longest_queue = 4;
  if (wanted.size() == longest_queue) wanted.pop_front();
  wanted.push_back(position);
  changed.notify_all();
}

void World::Impl::work(std::stop_token stop) {
  constexpr std::size_t kept = 8;
  std::unique_lock lock(mutex);
  while (changed.wait(lock, stop, [this] { return !wanted.empty(); })) {
    const Position position = wanted.front();
    lock.unlock();
    Frame frame = render(position);
    lock.lock();
    std::erase(wanted, position);
    frames.emplace_back(position, std::move(frame));
    if (frames.size() > kept) frames.pop_front();
    changed.notify_all();
  }
}

Frame World::Impl::wait(const Position& position) {
  std::unique_lock lock(mutex);
  Frame frame;
  while (!(frame = find(position))) {
    want(position);
    changed.wait(lock);
  }
  return frame;
}

double World::Impl::light() const {
  const double hours = std::chrono::duration<double>(Clock::now() - drift_start).count() / 3600;
  return std::max(0.0, 1 + drift_per_hour * hours);
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

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::~World() = default;

Result<std::unique_ptr<World>> World::create(const WorldOptions& options) {
  if (Status status = check(options); !status) return tl::unexpected(status.error());
  return std::unique_ptr<World>(new World(std::make_unique<Impl>(options)));
}

const Bench& World::bench() const { return impl_->bench; }

void World::prepare(const Vec2& stage_mm) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->want(position_of(stage_mm));
}

void World::wait_ready(const Vec2& stage_mm) { impl_->wait(position_of(stage_mm)); }

void World::expose(const Vec2& stage_mm, double exposure_s, double gain_db, int width_px, int height_px,
                   int offset_x_px, int offset_y_px, std::span<std::uint16_t> dn) {
  const Position position = position_of(stage_mm);
  const Frame frame = impl_->wait(position);
  Photosites::Exposure exposure{{position[0], position[1]}, exposure_s, gain_db, true, 1};
  {
    const std::scoped_lock lock(impl_->mutex);
    exposure.noise = impl_->noise;
    exposure.light = impl_->light();
  }
  // Photosites of the region that the sensor has; others read 0.
  std::fill(dn.begin(), dn.end(), std::uint16_t{0});
  const int columns = std::min(width_px, impl_->lens.width_px - offset_x_px);
  const int rows = std::min(height_px, impl_->lens.height_px - offset_y_px);
  if (columns <= 0 || offset_x_px < 0 || offset_y_px < 0) return;
  for (int j = 0; j < rows && static_cast<std::size_t>(j + 1) * width_px <= dn.size(); ++j) {
    const std::size_t first = static_cast<std::size_t>(j + offset_y_px) * impl_->lens.width_px + offset_x_px;
    impl_->photosites.expose(exposure, first, {frame->data() + first, static_cast<std::size_t>(columns)},
                             dn.subspan(static_cast<std::size_t>(j) * width_px, columns));
  }
}

Status World::set(const std::string& knob, double value) {
  const std::scoped_lock lock(impl_->mutex);
  if (knob == "noise" && (value == 0 || value == 1)) {
    impl_->noise = value == 1;
  } else if (knob == "lamp_drift" && std::isfinite(value)) {
    impl_->drift_per_hour = value;
    impl_->drift_start = Clock::now();
  } else {
    return fail("no knob \"" + knob + "\" that takes " + std::to_string(value), "virtual bench",
                "use noise 0|1 or lamp_drift <relative change per hour>");
  }
  return {};
}

}  // namespace lumifield::virtual_bench
