#include "renderer/methods/summed_evaluation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "renderer/methods/closed_form_shared.h"

namespace lumifield {

Status SummedEvaluation::take_cells(const LightField& light_field) {
  cells_.clear();
  images_.clear();
  for (int flat = 0; flat < geometry_.sampling.cells(); ++flat) {
    auto image = light_field.cell(geometry_.sampling.index(flat));
    if (!image) continue;
    cells_.push_back(geometry_.sampling.index(flat));
    images_.push_back(std::move(image));
  }
  return {};
}

Status SummedEvaluation::take_receivers(std::span<const Receiver> receivers) {
  receivers_.assign(receivers.begin(), receivers.end());
  const Status set = sums_->set_receivers(receivers_, appearance());
  clear_ = set.has_value();
  return set;
}

Status SummedEvaluation::begin() {
  if (!clear_)
    if (Status cleared = sums_->set_receivers(receivers_, appearance()); !cleared) return cleared;
  clear_ = true;
  next_ = 0;
  kernel_s_ = 0;
  return {};
}

std::size_t SummedEvaluation::fit(double seconds) const {
  const std::size_t left = cells_.size() - next_;
  if (!std::isfinite(seconds)) return left;
  const double each_s = next_ > 0 ? kernel_s_ / static_cast<double>(next_) : 0;
  const double cells = each_s > 0 ? seconds / each_s : GRID_CELLS;
  return std::min(left, static_cast<std::size_t>(std::clamp(cells, 1.0, 1e6)));
}

Result<bool> SummedEvaluation::go_on(double seconds) {
  const auto start = std::chrono::steady_clock::now();
  while (next_ < cells_.size()) {
    const double passed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::size_t count = fit(seconds - passed);
    const std::span<const std::shared_ptr<const CellImage>> images(images_);
    clear_ = false;
    if (Status added = sums_->add_cells(std::span(cells_).subspan(next_, count), images.subspan(next_, count)); !added)
      return tl::unexpected(added.error());
    kernel_s_ += sums_->last_kernel_s();
    next_ += count;
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() >= seconds) break;
  }
  return next_ == cells_.size();
}

double SummedEvaluation::share_computed() const {
  return static_cast<double>(next_) / static_cast<double>(std::max<std::size_t>(cells_.size(), 1));
}

Status SummedEvaluation::read_computed(std::span<double> irradiance) {
  if (next_ < cells_.size()) return {};
  std::vector<double> sums;
  if (Status read = sums_->read(sums); !read) return read;
  std::copy(sums.begin(), sums.end(), irradiance.begin());
  return {};
}

Status SummedEvaluation::read_gloss_computed(std::span<double> radiance) {
  if (next_ < cells_.size()) return {};
  std::vector<double> sums;
  if (Status read = sums_->read_gloss(sums); !read) return read;
  std::copy(sums.begin(), sums.end(), radiance.begin());
  return {};
}

}  // namespace lumifield
