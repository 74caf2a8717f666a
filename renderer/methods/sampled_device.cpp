#include "renderer/methods/sampled_device.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "luminaire/dataset.h"
#include "renderer/methods/host_method.h"

namespace lumifield {

namespace {

constexpr std::size_t work_group = 64;
/// Samples of the first band, before their time is known.
constexpr double first_samples = 1e5;

}  // namespace

Status check_same_luminaire(const LuminaireGeometry& cells, const LuminaireGeometry& method) {
  if (const auto difference = first_difference(cells, method))
    return fail("the cells are of another luminaire: its " + *difference, "method", "make the method for it");
  return {};
}

Status check_finite(std::span<const Receiver> receivers) {
  for (std::size_t k = 0; k < receivers.size(); ++k)
    if (!receivers[k].p_mm.allFinite() || !receivers[k].n.allFinite())
      return fail("has NaN or Inf", "receiver " + std::to_string(k), "give finite numbers");
  return {};
}

SampledDevice::SampledDevice(const LuminaireGeometry& geometry, const MethodSettings& settings)
    : geometry_(geometry), settings_(settings) {
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
  if (geometry_.channels.size() != 1 && geometry_.channels.size() != 3)
    return fail("a luminaire of " + std::to_string(geometry_.channels.size()) + " channels cannot be rendered",
                "channels", "give it the channel Y, or R, G, B");
  auto device = OpenClDevice::create();
  if (!device) return tl::unexpected(device.error());
  device_ = std::move(*device);
  const std::string options = "-DBASIS=" + std::to_string(static_cast<int>(geometry_.sampling.basis)) +
                              " -DCHANNELS=" + std::to_string(geometry_.channels.size()) + " " + defines;
  auto kernel = device_->build(source, options, function);
  if (!kernel) return tl::unexpected(kernel.error());
  kernel_ = *kernel;
  return {};
}

Status SampledDevice::check_receiver(const Receiver&) const { return {}; }

Status SampledDevice::set_receivers(std::span<const Receiver> receivers) {
  if (receivers.size() > std::size_t(1) << 30) return fail("more than 2^30 receivers", "receivers", "render in parts");
  if (const Status finite = check_finite(receivers); !finite) return finite;
  std::vector<SamplingReceiver> all;
  all.reserve(receivers.size());
  for (std::size_t k = 0; k < receivers.size(); ++k) {
    const Receiver& r = receivers[k];
    const bool lit = r.p_mm.z() > 0 && r.n != Vec3(0, 0, 0);
    if (lit)
      if (Status good = check_receiver(r); !good) {
        Error error = good.error();
        error.where += " " + std::to_string(k);
        return tl::unexpected(std::move(error));
      }
    all.push_back({r.p_mm.x(), r.p_mm.y(), r.p_mm.z(), r.n.x(), r.n.y(), r.n.z()});
  }
  count_ = 0;
  begin_anew(false);
  if (Status written = upload(receivers_, all, "receivers"); !written) return written;
  const std::vector<double> none(all.size() * geometry_.channels.size(), 0.0);
  if (Status written = upload(sums_, none, "irradiance"); !written) return written;
  count_ = all.size();
  return {};
}

Status SampledDevice::set_samples(double samples, std::uint32_t seed) {
  MethodSettings settings = settings_;
  settings.samples = samples;
  settings.seed = seed;
  if (const Status good = check_settings(settings); !good) return good;
  settings_ = settings;
  begin_anew(true);
  return {};
}

void SampledDevice::begin_anew(bool with_points) {
  begun_ = false;
  if (with_points) points_made_ = false;
}

Status SampledDevice::begin() {
  shared_.samples = settings_.samples;
  shared_.k_max = settings_.k_max;
  shared_.seed = settings_.seed;
  shared_.twister = settings_.sequence == PointSequence::twister;
  if (!points_made_)
    if (Status made = make_points(); !made) return made;
  points_made_ = true;
  if (count_ > 0)
    if (Status cleared = device_->zero(sums_); !cleared) return cleared;
  next_ = 0;
  kernel_s_ = 0;
  begun_ = true;
  return {};
}

Result<bool> SampledDevice::evaluate(double seconds) {
  if (!begun_)
    if (const Status begins = begin(); !begins) return tl::unexpected(begins.error());
  set_arguments(kernel_);
  const auto start = std::chrono::steady_clock::now();
  while (next_ < count_) {
    // As many as fit into what is left by the time that those before took.
    const double left = seconds - std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double each_s = next_ > 0 ? kernel_s_ / static_cast<double>(next_) : 0;
    const double fit = !std::isfinite(seconds) ? static_cast<double>(count_)
                       : each_s > 0            ? left / each_s
                                               : first_samples / shared_.samples;
    const auto band =
        static_cast<std::size_t>(std::max(std::min(fit, static_cast<double>(count_)), static_cast<double>(work_group)));
    const std::size_t end = std::min(next_ + band, count_);
    shared_.first_receiver = static_cast<int>(next_);
    shared_.receivers = static_cast<int>(end);
    kernel_.set(0, shared_);
    const auto took = device_->run(kernel_, end - next_, work_group);
    if (!took) {
      begun_ = false;
      return tl::unexpected(took.error());
    }
    kernel_s_ += *took;
    next_ = end;
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() >= seconds) break;
  }
  return next_ == count_;
}

Status SampledDevice::read(std::vector<double>& irradiance) {
  irradiance.resize(count_ * geometry_.channels.size());
  return device_->read(sums_, std::as_writable_bytes(std::span(irradiance)));
}

}  // namespace lumifield
