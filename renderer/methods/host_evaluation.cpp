#include "renderer/methods/host_evaluation.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>
#include <thread>

#include "renderer/methods/sampled_device.h"

namespace lumifield {

namespace {

/// Receivers between two looks at the clock.
constexpr std::size_t band = 256;

}  // namespace

Status HostEvaluation::set_cells(const LightField& light_field) {
  if (const Status same = check_same_luminaire(light_field.geometry(), geometry_); !same) return same;
  light_field_ = light_field;
  form_.reset();
  return {};
}

Status HostEvaluation::set_receivers(std::span<const Receiver> receivers) {
  if (const Status finite = check_finite(receivers); !finite) return finite;
  receivers_.assign(receivers.begin(), receivers.end());
  irradiance_.assign(receivers_.size() * geometry_.channels.size(), 0.0);
  next_ = 0;
  took_s_ = 0;
  return {};
}

Status HostEvaluation::set_samples(double samples, std::uint32_t seed) {
  MethodSettings settings = settings_;
  settings.samples = samples;
  settings.seed = seed;
  if (const Status good = check_settings(settings); !good) return good;
  settings_ = settings;
  form_.reset();
  return {};
}

Result<bool> HostEvaluation::evaluate(double seconds) {
  if (!light_field_) return no_cells();
  if (!form_) {
    auto made = make_host_method(*light_field_, settings_);
    if (!made) return tl::unexpected(made.error());
    form_ = std::move(*made);
    next_ = receivers_.size();
  }
  if (next_ == receivers_.size()) {
    std::fill(irradiance_.begin(), irradiance_.end(), 0.0);
    next_ = 0;
    took_s_ = 0;
  }
  const auto start = std::chrono::steady_clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const std::size_t channels = geometry_.channels.size();
  // Each thread keeps its own first error.
  const auto compute = [&](std::size_t begin, std::size_t end, std::optional<Error>& error) {
    try {
      for (std::size_t k = begin; k < end && !error; ++k) {
        if (receivers_[k].n == Vec3(0, 0, 0)) continue;
        const auto e = form_->irradiance(receivers_[k], static_cast<std::uint32_t>(k));
        if (!e)
          error = e.error();
        else
          std::copy(e->begin(), e->end(), irradiance_.begin() + static_cast<std::ptrdiff_t>(k * channels));
      }
    } catch (const std::exception& thrown) {
      error =
          Error{std::string("stopped: ") + thrown.what(), "host evaluation", "give fewer receivers, or more memory"};
    }
  };
  do {
    const std::size_t end = std::min(next_ + band, receivers_.size()), middle = next_ + (end - next_) / 2;
    std::optional<Error> errors[2];
    {
      const std::jthread other([&] { compute(middle, end, errors[1]); });
      compute(next_, middle, errors[0]);
    }
    for (const auto& error : errors)
      if (error) {
        form_.reset();
        return tl::unexpected(*error);
      }
    next_ = end;
  } while (next_ < receivers_.size() && passed() < seconds);
  took_s_ += passed();
  return next_ == receivers_.size();
}

Status HostEvaluation::read(std::vector<double>& irradiance) {
  irradiance = irradiance_;
  return {};
}

}  // namespace lumifield
