#pragma once

#include "renderer/methods/device_images.h"
#include "renderer/methods/method.h"
#include "renderer/methods/ray_light_shared.h"
#include "renderer/opencl/device.h"

namespace lumifield {

/// All cells' images on the device as ray_light.clh looks them up (RayLight). Thread-bound.
class RayImages {
 public:
  RayImages(const LuminaireGeometry& geometry, bool with_levels);

  /// Errors: images beyond what a kernel counts, more than they may take, the device's.
  /// further_bytes: of other tables, which count with the images.
  Status upload(OpenClDevice& device, const LightField& light_field, const MethodSettings& settings,
                double further_bytes);
  /// Refuses other tables that are too much beside the images.
  Status check_memory(const OpenClDevice& device, const MethodSettings& settings, double further_bytes) const;
  /// Floats from row to row of an image's finest level.
  std::size_t stride() const {
    return layout_.levels().empty() ? 0 : static_cast<std::size_t>(layout_.levels()[0].stride);
  }
  /// But the samples and points.
  const RayGeometry& geometry() const { return shared_; }
  /// Of each cell of the grid its image, −1 where unmeasured; the levels; the images.
  const DeviceBuffer& slots() const { return slots_; }
  const DeviceBuffer& levels() const { return levels_; }
  const DeviceBuffer& images() const { return images_; }

 private:
  DeviceImages layout_;
  RayGeometry shared_{};
  double bytes_ = 0;  ///< of all images
  DeviceBuffer slots_, levels_, images_;
};

}  // namespace lumifield
