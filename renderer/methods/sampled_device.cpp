#include "renderer/methods/sampled_device.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "renderer/methods/host_method.h"

namespace lumifield {

namespace {

constexpr std::size_t work_group = 64;
/// Samples of the first band, before their time is known.
constexpr double first_samples = 1e5;
/// Of a later one where the caller must not be held up: receivers that see nothing take no time and foretell none.
constexpr double most_band_samples = 3e6;

}  // namespace

SampledDevice::SampledDevice(const LuminaireGeometry& geometry, const MethodSettings& settings)
    : DeviceMethod(geometry, settings) {
  const Measurement& m = geometry.measurement;
  shared_.separation = geometry.planes.separation_mm;
  shared_.spacing_x = geometry.sampling.spacing_mm.x();
  shared_.spacing_y = geometry.sampling.spacing_mm.y();
  shared_.corner_x = m.corner_mm().x();
  shared_.corner_y = m.corner_mm().y();
  shared_.pixel_x = m.pixel_mm.x();
  shared_.pixel_y = m.pixel_mm.y();
  shared_.width = m.width_px;
  shared_.height = m.height_px;
}

Status SampledDevice::open(std::string_view source, const std::string& function, const std::string& defines) {
  if (const Status good = check_settings(settings_); !good) return good;
  if (settings_.inversion != Inversion::secant)
    return fail("the kernels search by the modified secant alone", "inversion", "use the host's form");
  if (settings_.depth != whole_depth)
    return fail("the kernels search to the end", "depth of the search", "use the host's form");
  if (geometry_.channels.size() != 1 && geometry_.channels.size() != 3)
    return fail("a luminaire of " + std::to_string(geometry_.channels.size()) + " channels cannot be rendered",
                "channels", "give it the channel Y, or R, G, B");
  auto device = OpenClDevice::create();
  if (!device) return tl::unexpected(device.error());
  device_ = std::move(*device);
  source_ = source;
  function_ = function;
  defines_ = defines;
  return build();
}

/// The kernel for the receivers' appearance, built once.
Status SampledDevice::build() {
  const int lobes = gloss_channels() == 0 ? 0 : appearance().is_grey() ? 1 : 3;
  const std::string looks =
      " -DSHADOW=" + std::string(appearance().visible.empty() ? "0" : "1") + " -DLOBES=" + std::to_string(lobes);
  if (const auto made = kernels_.find(looks); made != kernels_.end()) {
    kernel_ = made->second;
    return {};
  }
  const std::string options = "-DBASIS=" + std::to_string(static_cast<int>(geometry_.sampling.basis)) +
                              " -DCHANNELS=" + std::to_string(geometry_.channels.size()) + looks + " " + defines_;
  auto kernel = device_->build(source_, options, function_);
  if (!kernel) return tl::unexpected(kernel.error());
  kernel_ = kernels_[looks] = *kernel;
  return {};
}

Status SampledDevice::take_appearance() {
  if (Status built = build(); !built) return built;
  const TileVisibility& visible = appearance().visible;
  const TileGrid grid(geometry_.sampling);
  looks_ = {grid.columns, grid.rows, static_cast<int>(visible.row_words()), visible.weighing == ShadowWeighing::mean,
            geometry_.sampling.columns};
  if (Status done = device_->fill(bits_, visible.words, "shadows"); !done) return done;
  if (Status done = device_->fill(lobes_, appearance().gloss, "lobes"); !done) return done;
  return device_->make_room(gloss_, receivers() * gloss_channels() * sizeof(double), "radiance by gloss");
}

void SampledDevice::set_looks(DeviceKernel& kernel, unsigned number) {
  kernel.set(number++, looks_);
  for (const DeviceBuffer& buffer : {bits_, lobes_, gloss_}) kernel.set(number++, buffer);
}

Status SampledDevice::take_receivers(std::span<const Receiver> receivers) {
  std::vector<SamplingReceiver> all;
  all.reserve(receivers.size());
  for (const Receiver& r : receivers)
    all.push_back({r.p_mm.x(), r.p_mm.y(), lit_height_mm(r.p_mm.z()), r.n.x(), r.n.y(), r.n.z()});
  if (Status written = device_->fill(receivers_, all, "receivers"); !written) return written;
  if (Status taken = take_appearance(); !taken) return taken;
  return device_->make_room(sums_, all.size() * channels() * sizeof(double), "irradiance");
}

Status SampledDevice::begin() {
  shared_.samples = settings_.samples;
  shared_.k_max = settings_.k_max;
  shared_.seed = settings_.seed;
  shared_.twister = settings_.sequence == PointSequence::twister;
  if (!points_made_)
    if (Status made = make_points(); !made) return made;
  points_made_ = true;
  if (receivers() > 0)
    for (const DeviceBuffer& sums : {sums_, gloss_})
      if (Status cleared = device_->zero(sums); !cleared) return cleared;
  next_ = 0;
  kernel_s_ = 0;
  return {};
}

double SampledDevice::rays_of_a_receiver() const { return info(settings_.method).samples > 0 ? settings_.samples : 1; }

/// As many as fit by the time that those before took.
std::size_t SampledDevice::band(double seconds) const {
  const auto all = static_cast<double>(receivers());
  const double each_s = next_ > 0 ? kernel_s_ / static_cast<double>(next_) : 0;
  const double rays = rays_of_a_receiver();
  const double fit = !std::isfinite(seconds) ? all
                     : each_s > 0            ? std::min(seconds / each_s, most_band_samples / rays)
                                             : first_samples / rays;
  return static_cast<std::size_t>(std::max(std::min(fit, all), static_cast<double>(work_group)));
}

Result<bool> SampledDevice::go_on(double seconds) {
  set_looks(kernel_, set_arguments(kernel_));
  const auto start = std::chrono::steady_clock::now();
  const auto left = [&] {
    return seconds - std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  while (next_ < receivers()) {
    const std::size_t end = std::min(next_ + band(left()), receivers());
    shared_.first_receiver = static_cast<int>(next_);
    shared_.receivers = static_cast<int>(end);
    kernel_.set(0, shared_);
    const auto took = device_->run(kernel_, end - next_, work_group);
    if (!took) return tl::unexpected(took.error());
    kernel_s_ += *took;
    next_ = end;
    if (!(left() > 0)) break;
  }
  return next_ == receivers();
}

double SampledDevice::share_computed() const {
  return static_cast<double>(next_) / static_cast<double>(std::max<std::size_t>(receivers(), 1));
}

Status SampledDevice::read_computed(std::span<double> irradiance) {
  return device_->read(sums_, std::as_writable_bytes(irradiance));
}

Status SampledDevice::read_gloss_computed(std::span<double> radiance) {
  return device_->read(gloss_, std::as_writable_bytes(radiance));
}

}  // namespace lumifield
