#include "renderer/methods/closed_form_evaluation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "renderer/methods/host_method.h"
#include "renderer/methods/sampled_device.h"

namespace lumifield {

Result<std::unique_ptr<ClosedFormEvaluation>> ClosedFormEvaluation::create(const LuminaireGeometry& geometry,
                                                                           const MethodSettings& settings) {
  auto device = ClosedFormDevice::create(geometry);
  if (!device) return tl::unexpected(device.error());
  if (Status set = (*device)->set_lod(settings.lod); !set) return tl::unexpected(set.error());
  return std::unique_ptr<ClosedFormEvaluation>(new ClosedFormEvaluation(geometry, settings, std::move(*device)));
}

Status ClosedFormEvaluation::set_cells(const LightField& light_field) {
  if (const Status same = check_same_luminaire(light_field.geometry(), geometry_); !same) return same;
  light_field_ = light_field;
  begun_ = false;
  return {};
}

Status ClosedFormEvaluation::set_receivers(std::span<const Receiver> receivers) {
  clear_ = false;
  if (const Status set = device_->set_receivers(receivers); !set) return set;
  receivers_.assign(receivers.begin(), receivers.end());
  clear_ = true;
  begun_ = false;
  return {};
}

Status ClosedFormEvaluation::set_samples(double samples, std::uint32_t seed) {
  MethodSettings settings = settings_;
  settings.samples = samples;
  settings.seed = seed;
  if (const Status good = check_settings(settings); !good) return good;
  settings_ = settings;
  return {};
}

Status ClosedFormEvaluation::add_rows(int rows) {
  std::vector<CellIndex> cells;
  std::vector<std::shared_ptr<const CellImage>> images;
  std::vector<const CellImage*> pointers;
  for (const int end = next_row_ + rows; next_row_ < end; ++next_row_)
    for (int column = 0; column < geometry_.sampling.columns; ++column) {
      auto image = light_field_->cell({next_row_, column});
      if (!image) continue;
      cells.push_back({next_row_, column});
      pointers.push_back(image.get());
      images.push_back(std::move(image));
    }
  const Status added = device_->add_cells(cells, pointers);
  kernel_s_ += device_->last_kernel_s();
  return added;
}

Result<bool> ClosedFormEvaluation::evaluate(double seconds) {
  if (!light_field_) return no_cells();
  const int all = geometry_.sampling.rows;
  if (!begun_ || next_row_ == all) {
    if (!clear_)
      if (Status cleared = device_->set_receivers(receivers_); !cleared) return tl::unexpected(cleared.error());
    begun_ = true;
    next_row_ = 0;
    kernel_s_ = 0;
  }
  clear_ = false;
  const auto start = std::chrono::steady_clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  do {
    // Rows together share what is theirs; one by one where the clock is looked at.
    if (Status added = add_rows(std::isinf(seconds) ? all - next_row_ : 1); !added) {
      begun_ = false;
      return tl::unexpected(added.error());
    }
  } while (next_row_ < all && passed() < seconds);
  return next_row_ == all;
}

}  // namespace lumifield
