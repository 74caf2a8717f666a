#include "renderer/methods/host_evaluation.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>

namespace lumifield {

namespace {

/// Receivers between two looks at the clock.
constexpr std::size_t band = 256;

tl::unexpected<Error> as_error(const std::exception& thrown) {
  return fail(std::string("the computation was given up: ") + thrown.what(), "host, double precision",
              "close other programs or use a smaller luminaire");
}

}  // namespace

Status HostEvaluation::take_cells(const LightField& light_field) {
  light_field_ = light_field;
  return {};
}

Status HostEvaluation::take_receivers(std::span<const Receiver> receivers) {
  receivers_.assign(receivers.begin(), receivers.end());
  return {};
}

Status HostEvaluation::begin() {
  if (!form_) try {
      auto made = make_(*light_field_, settings_);
      if (!made) return tl::unexpected(made.error());
      form_ = std::move(*made);
    } catch (const std::exception& error) {
      return as_error(error);
    }
  irradiance_.assign(receivers_.size() * channels(), 0.0);
  gloss_.assign(receivers_.size() * gloss_channels(), 0.0);
  next_ = 0;
  took_s_ = 0;
  return {};
}

Status HostEvaluation::compute(std::size_t begin, std::size_t end) {
  for (std::size_t k = begin; k < end; ++k) {
    if (receivers_[k].n == Vec3(0, 0, 0)) continue;
    const auto e = form_->light(receivers_[k], static_cast<std::uint32_t>(k), appearance().look(k));
    if (!e) return tl::unexpected(e.error());
    std::copy_n(e->begin(), channels(), irradiance_.begin() + static_cast<std::ptrdiff_t>(k * channels()));
    // A grey lobe among coloured ones gives one value for all.
    const std::size_t given = e->size() - channels();
    for (std::size_t c = 0; given > 0 && c < gloss_channels(); ++c)
      gloss_[k * gloss_channels() + c] = (*e)[channels() + c % given];
  }
  return {};
}

/// What a thread throws crosses to the caller's, where it becomes an Error.
Status HostEvaluation::compute_on_two_threads(std::size_t begin, std::size_t end) {
  const std::size_t middle = begin + (end - begin) / 2;
  Status first, second;
  std::exception_ptr thrown;
  try {
    {
      const std::jthread other([&] {
        try {
          second = compute(middle, end);
        } catch (...) {
          thrown = std::current_exception();
        }
      });
      first = compute(begin, middle);
    }
    if (thrown) std::rethrow_exception(thrown);
  } catch (const std::exception& error) {
    return as_error(error);
  }
  return first ? second : first;
}

Result<bool> HostEvaluation::go_on(double seconds) {
  const auto start = std::chrono::steady_clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  do {
    const std::size_t end = std::min(next_ + band, receivers_.size());
    if (const Status computed = compute_on_two_threads(next_, end); !computed) return tl::unexpected(computed.error());
    next_ = end;
  } while (next_ < receivers_.size() && passed() < seconds);
  took_s_ += passed();
  return next_ == receivers_.size();
}

double HostEvaluation::share_computed() const {
  return static_cast<double>(next_) / static_cast<double>(std::max<std::size_t>(receivers(), 1));
}

Status HostEvaluation::read_computed(std::span<double> irradiance) {
  std::copy(irradiance_.begin(), irradiance_.end(), irradiance.begin());
  return {};
}

Status HostEvaluation::read_gloss_computed(std::span<double> radiance) {
  std::copy(gloss_.begin(), gloss_.end(), radiance.begin());
  return {};
}

}  // namespace lumifield
