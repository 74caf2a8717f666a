#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "luminaire/error.h"

namespace lumifield {

/// An open V4L2 device that captures single-plane pictures by streaming. Thread-bound.
///
/// The path need not be a character device: whatever answers V4L2's requests is one. Opening it changes nothing in the
/// camera, and another program may have it open too: who streams is settled when buffers are asked for.
/// Source: Linux Media Subsystem Documentation, Video for Linux API.
class V4l2Node {
 public:
  /// Errors: nothing there, no permission, held by another program, no camera.
  static Result<V4l2Node> open(const std::string& path);
  ~V4l2Node();
  V4l2Node(V4l2Node&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)),
        path_(std::move(other.path_)),
        driver_(std::move(other.driver_)),
        model_(std::move(other.model_)),
        bus_(std::move(other.bus_)) {}
  V4l2Node& operator=(V4l2Node&&) = delete;

  /// One request, tried again when a signal interrupts it. 0, or errno.
  int call(unsigned long request, void* argument) const;
  /// Whether the camera still answers. 0, or errno.
  int check() const;

  int descriptor() const { return descriptor_; }
  const std::string& path() const { return path_; }
  const std::string& driver() const { return driver_; }
  const std::string& model() const { return model_; }
  /// The serial number, where the bus has one, else the bus address.
  std::string serial() const;
  /// Who makes it, where the bus tells.
  std::string vendor() const;

  tl::unexpected<Error> error(std::string what, std::string remedy) const {
    return fail(std::move(what), "camera " + path_, std::move(remedy));
  }
  /// "does not take WHAT (errno)", or that another program holds it.
  tl::unexpected<Error> refused(const std::string& what, int failure) const;

 private:
  V4l2Node(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}
  Status identify();
  std::string bus_property(const char* name) const;

  int descriptor_ = -1;
  std::string path_, driver_, model_, bus_;
};

/// errno of a device that was unplugged, or whose server ended.
bool means_gone(int failure);

}  // namespace lumifield
