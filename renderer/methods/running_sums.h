#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/light_field.h"
#include "renderer/methods/appearance.h"
#include "renderer/methods/receiver.h"

namespace lumifield {

/// The irradiance of receivers as one running sum each, to which cells are added on a device: a new cell costs one
/// cell, a retaken one two. What methods are whose cells share nothing. Thread-bound to its creator.
class RunningSums {
 public:
  virtual ~RunningSums() = default;

  /// Replaces the receivers and clears the sums. A receiver with n = 0 gets 0 (background of a picture).
  /// After an error of the device there are none. For pictures: 4 floats each, interleaved, p in mm and n, luminaire
  /// frame.
  /// `appearance`: what they see of U, and how they shine; of other receivers or tiles it is refused.
  virtual Status set_receivers(std::span<const Receiver> receivers, const Appearance& appearance = {}) = 0;
  virtual Status set_receivers(std::span<const float> p_xyzw, std::span<const float> n_xyzw,
                               const Appearance& appearance = {}) = 0;

  /// Adds many in one go, images that do not change. It may hold them, to have them at hand for other receivers.
  virtual Status add_cells(std::span<const CellIndex> cells,
                           std::span<const std::shared_ptr<const CellImage>> images) = 0;
  /// Adds one; the difference to `before`, where that has been added.
  virtual Status replace_cell(CellIndex cell, const std::shared_ptr<const CellImage>& image,
                              const std::shared_ptr<const CellImage>& before) = 0;

  /// E, receiver-major: receivers · channels.
  virtual Status read(std::vector<double>& irradiance) = 0;
  /// Radiance by gloss towards the eye: receivers · gloss_channels of the appearance.
  virtual Status read_gloss(std::vector<double>& radiance) = 0;

  virtual std::string device_name() const = 0;
  /// Time on the device of the last add, seconds.
  virtual double last_kernel_s() const = 0;
};

}  // namespace lumifield
