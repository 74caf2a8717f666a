#include "renderer/methods/closed_form_tiles_device.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/closed_form_tiles.h"
#include "renderer/methods/gloss.h"

namespace lumifield {

namespace {

/// Of the corners' lobes that a run holds: on a processor they stay in its cache.
constexpr std::size_t corner_bytes_on_cpu = std::size_t(4) << 20, corner_bytes_elsewhere = std::size_t(256) << 20;
/// A column's moments are kept for as many subtiles a tile.
constexpr int most_kept_division = 2;

Receiver receiver_of(const ClosedFormReceiver& r) { return {{r.p_x, r.p_y, r.p_z}, {r.n_x, r.n_y, r.n_z}}; }

bool is_lit(const ClosedFormReceiver& r) { return r.p_z > 0 && (r.n_x != 0 || r.n_y != 0 || r.n_z != 0); }

}  // namespace

ClosedFormTilesDevice::List& ClosedFormTilesDevice::list_of(int division, int lobes) {
  const auto found =
      std::ranges::find_if(lists_, [&](const List& l) { return l.division == division && l.lobes == lobes; });
  if (found != lists_.end()) return *found;
  lists_.emplace_back();
  lists_.back().division = division;
  lists_.back().lobes = lobes;
  return lists_.back();
}

void ClosedFormTilesDevice::fill(List& list, std::size_t k, const ClosedFormReceiver& receiver,
                                 const Appearance& appearance) {
  list.receivers.push_back(receiver);
  list.number.push_back(static_cast<int>(k));
  if (list.lobes > 0) list.gloss.push_back(appearance.gloss[k]);
  if (sees_all_) return;
  const std::size_t words = appearance.visible.receiver_words();
  const auto begin = appearance.visible.words.begin() + static_cast<std::ptrdiff_t>(k * words);
  list.bits.insert(list.bits.end(), begin, begin + static_cast<std::ptrdiff_t>(words));
}

Status ClosedFormTilesDevice::take(std::vector<ClosedFormReceiver>& all, const Appearance& appearance, double lod) {
  for (List& list : lists_) {
    list.receivers.clear();
    list.number.clear();
    list.bits.clear();
    list.gloss.clear();
  }
  outs_ = 0;
  receivers_ = all.size();
  if (const Status good = check_appearance(appearance, grid_, all.size()); !good) return good;
  sees_all_ = appearance.visible.empty();
  mean_ = appearance.visible.weighing == ShadowWeighing::mean;
  outs_ = appearance.gloss_channels(geometry_.channels.size());
  const int lobes = appearance.is_grey() ? 1 : 3;

  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!is_lit(all[k])) continue;
    const Sight sight = sees_all_ ? Sight::all : sight_of(appearance.visible, k);
    if (sight != Sight::none && outs_ > 0 && appearance.gloss[k].kind != LOBE_NONE) {
      const int division = gloss_division(grid_, receiver_of(all[k]), appearance.gloss[k], sight == Sight::all || mean_,
                                          gloss_tolerance(lod));
      fill(list_of(division, lobes), k, all[k], appearance);
    }
    if (sight == Sight::some) fill(list_of(1, 0), k, all[k], appearance);
    if (sight != Sight::all) all[k].n_x = all[k].n_y = all[k].n_z = 0;
  }
  for (List& list : lists_) {
    if (list.receivers.empty()) continue;
    if (const Status built = build(list); !built) return built;
    if (const Status there = upload(list); !there) return there;
  }
  if (outs_ == 0) return {};
  if (auto room = device_.make_room(radiance_, all.size() * outs_ * sizeof(double), "radiance by gloss"); !room)
    return room;
  return device_.zero(radiance_);
}

Status ClosedFormTilesDevice::build(List& list) {
  if (list.built) return {};
  const bool keep = device_.is_cpu() && list.division <= most_kept_division;
  const std::string options = "-DBASIS=" + std::to_string(static_cast<int>(geometry_.sampling.basis)) +
                              " -DCHANNELS=" + std::to_string(geometry_.channels.size()) +
                              " -DDIVISION=" + std::to_string(list.division) +
                              " -DLOBES=" + std::to_string(list.lobes) + " -DKEEP=" + (keep ? "1" : "0");
  auto kernel = device_.build("closed_form_tiles", options, "closed_form_tiles");
  if (!kernel) return tl::unexpected(kernel.error());
  list.kernel = *kernel;
  list.built = list.lobes == 0;
  if (list.built) return {};
  auto lobe_kernel = device_.another(*kernel, "tile_lobes");
  if (!lobe_kernel) return tl::unexpected(lobe_kernel.error());
  list.lobe_kernel = *lobe_kernel;
  list.built = true;
  return {};
}

Status ClosedFormTilesDevice::upload(List& list) {
  if (auto done = device_.fill(list.receivers_on, list.receivers, "receivers in half-shadow"); !done) return done;
  if (auto done = device_.fill(list.number_on, list.number, "their numbers"); !done) return done;
  if (auto done = device_.fill(list.bits_on, list.bits, "what they see"); !done) return done;
  if (list.lobes == 0) return {};
  return device_.fill(list.gloss_on, list.gloss, "lobes");
}

namespace {

std::size_t corners_of(const TileGrid& grid, int division) {
  const int nodes = std::max(division, 1);
  return static_cast<std::size_t>(grid.columns * nodes + 1) * static_cast<std::size_t>(grid.rows * nodes + 1);
}

}  // namespace

/// Receivers whose lobes are held at a time.
std::size_t ClosedFormTilesDevice::batch_of(const List& list) const {
  if (list.lobes == 0) return list.receivers.size();
  const std::size_t each = corners_of(grid_, list.division) * static_cast<std::size_t>(list.lobes) * sizeof(float);
  return std::max<std::size_t>((device_.is_cpu() ? corner_bytes_on_cpu : corner_bytes_elsewhere) / each, 64);
}

/// First column and row of the subtiles' corners that the run's cells have, and how many.
std::array<int, 4> ClosedFormTilesDevice::window_of(const ClosedFormRun& run, int nodes) const {
  const int tiles_x = grid_.columns - geometry_.sampling.columns, tiles_y = grid_.rows - geometry_.sampling.rows;
  return {run.first.column * nodes, run.first.row * nodes, (run.grid.columns + tiles_x) * nodes + 1,
          (run.grid.rows + tiles_y) * nodes + 1};
}

Result<double> ClosedFormTilesDevice::run_list(List& list, const ClosedFormRun& run) {
  const std::size_t batch = batch_of(list), all = list.receivers.size();
  const std::array<int, 4> window = window_of(run, std::max(list.division, 1));
  const std::size_t corner_floats =
      std::min(batch, all) * corners_of(grid_, list.division) * static_cast<std::size_t>(list.lobes);
  if (auto room = device_.make_room(corners_, corner_floats * sizeof(float), "lobes at the tiles' corners"); !room)
    return tl::unexpected(room.error());
  DeviceKernel& kernel = list.kernel;
  unsigned at = 0;
  kernel.set(at++, run.geometry);
  for (const DeviceBuffer& buffer :
       {list.receivers_on, run.cells, run.images, run.levels, list.lobes > 0 ? radiance_ : run.sums})
    kernel.set(at++, buffer);
  kernel.set(at++, run.grid);
  kernel.set(at++, run.centers);
  kernel.set(at++, run.row_begins);
  kernel.set(at + 1, list.number_on);
  kernel.set(at + 2, list.bits_on);
  kernel.set(at + 3, corners_);

  double seconds = 0;
  for (std::size_t begin = 0; begin < all; begin += batch) {
    const std::size_t count = std::min(batch, all - begin);
    const ClosedFormTiles tiles{grid_.columns,
                                grid_.rows,
                                sees_all_ ? 0 : (grid_.columns + 31) / 32,
                                mean_,
                                run.first.column,
                                run.first.row,
                                static_cast<int>(begin),
                                static_cast<int>(begin + count)};
    if (list.lobes > 0) {
      list.lobe_kernel.set(0, tiles);
      list.lobe_kernel.set(1, list.receivers_on);
      list.lobe_kernel.set(2, list.gloss_on);
      list.lobe_kernel.set(3,
                           std::array{grid_.corner_mm.x(), grid_.corner_mm.y(), grid_.size_mm.x(), grid_.size_mm.y()});
      list.lobe_kernel.set(4, window);
      list.lobe_kernel.set(5, corners_);
      const auto took = device_.run(list.lobe_kernel, count * static_cast<std::size_t>(window[3]), 64);
      if (!took) return took;
      seconds += *took;
    }
    kernel.set(at, tiles);
    const auto took = device_.run(kernel, count, device_.is_cpu() ? 1 : 64);
    if (!took) return took;
    seconds += *took;
  }
  return seconds;
}

Result<double> ClosedFormTilesDevice::run(const ClosedFormRun& run) {
  double seconds = 0;
  for (List& list : lists_) {
    if (list.receivers.empty()) continue;
    const auto took = run_list(list, run);
    if (!took) return took;
    seconds += *took;
  }
  return seconds;
}

Status ClosedFormTilesDevice::read_gloss(std::vector<double>& radiance) {
  radiance.assign(receivers_ * outs_, 0.0);
  return outs_ == 0 ? Status{} : device_.read(radiance_, std::as_writable_bytes(std::span(radiance)));
}

}  // namespace lumifield
