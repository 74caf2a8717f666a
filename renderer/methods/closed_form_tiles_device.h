#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "renderer/methods/appearance.h"
#include "renderer/methods/closed_form_shared.h"
#include "renderer/opencl/device.h"

namespace lumifield {

/// A run of cells as ClosedFormDevice has it on the device.
struct ClosedFormRun {
  ClosedFormGeometry geometry;
  ClosedFormGrid grid;
  CellIndex first;  ///< of the grid
  DeviceBuffer cells, images, levels, sums, centers, row_begins;
};

/// What ClosedFormDevice leaves out: the irradiance of receivers that see a part of U, and what is reflected by those
/// that shine (ClosedForm::light as a kernel). Thread-bound; the device outlives it.
class ClosedFormTilesDevice {
 public:
  ClosedFormTilesDevice(OpenClDevice& device, const LuminaireGeometry& geometry)
      : device_(device), geometry_(geometry), grid_(geometry.sampling) {}

  /// Takes what it is to compute of `all`, and clears the radiance. The receivers that see a part of U or nothing get n
  /// = 0 in `all`. Errors: an appearance of other receivers or tiles, a lobe that is not finite, the device's.
  Status take(std::vector<ClosedFormReceiver>& all, const Appearance& appearance, double lod);
  bool empty() const {
    return std::ranges::all_of(lists_, [](const List& list) { return list.receivers.empty(); });
  }
  /// Adds a run's cells to the sums of irradiance and to the radiance: the kernels' time, seconds.
  Result<double> run(const ClosedFormRun& run);
  /// Radiance by gloss: receivers · outs.
  Status read_gloss(std::vector<double>& radiance);

 private:
  /// Receivers of one kernel; both kernel and buffers stay for the next ones.
  struct List {
    int division = 1, lobes = 0;  ///< 0: irradiance
    std::vector<ClosedFormReceiver> receivers;
    std::vector<int> number;
    std::vector<std::uint32_t> bits;
    std::vector<GlossLobe> gloss;
    DeviceBuffer receivers_on, number_on, bits_on, gloss_on;
    DeviceKernel kernel, lobe_kernel;
    bool built = false;
  };

  List& list_of(int division, int lobes);
  void fill(List& list, std::size_t k, const ClosedFormReceiver& receiver, const Appearance& appearance);
  Status build(List& list);
  Status upload(List& list);
  Result<double> run_list(List& list, const ClosedFormRun& run);
  std::size_t batch_of(const List& list) const;
  std::array<int, 4> window_of(const ClosedFormRun& run, int nodes) const;

  OpenClDevice& device_;
  const LuminaireGeometry& geometry_;
  TileGrid grid_;
  bool mean_ = false, sees_all_ = true;
  std::size_t outs_ = 0, receivers_ = 0;  ///< values of radiance a receiver, 0 where none shines
  std::vector<List> lists_;
  DeviceBuffer corners_, radiance_;
};

}  // namespace lumifield
