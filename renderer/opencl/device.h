#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "luminaire/error.h"

// OpenCL's own opaque handles.
struct _cl_mem;
struct _cl_kernel;
struct _cl_program;

namespace lumifield {

/// Memory on the device. Value type: copies share it.
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  std::size_t bytes() const { return bytes_; }

 private:
  friend class OpenClDevice;
  friend class DeviceKernel;
  std::shared_ptr<_cl_mem> handle_;
  std::size_t bytes_ = 0;
};

/// One kernel function with its arguments. Thread-bound.
class DeviceKernel {
 public:
  DeviceKernel() = default;

  /// Sets the argument of this number; an error is kept, and reported by OpenClDevice::run, until it is set again.
  void set(unsigned number, const DeviceBuffer& buffer);
  template <class T>
  void set(unsigned number, const T& value) {
    set_bytes(number, &value, sizeof value);
  }

 private:
  friend class OpenClDevice;
  void set_bytes(unsigned number, const void* value, std::size_t bytes);
  std::shared_ptr<_cl_kernel> handle_;
  std::string name_;
  std::map<unsigned, int> errors_;  ///< by argument, those not set
};

/// One OpenCL device with its context and its in-order queue: the only user of OpenCL in the program, OpenCL C 1.2.
/// A device must compute in double precision. Thread-bound to its creator.
class OpenClDevice {
 public:
  /// The device whose name contains $LUMIFIELD_OPENCL (any case), else the first GPU, else the first of any kind.
  /// OpenCL is probed in a child process before (probe_opencl), since a driver may abort. Errors: no platform, no
  /// device, no such device, no double precision, a driver that aborts or hangs.
  static Result<std::unique_ptr<OpenClDevice>> create();
  ~OpenClDevice();

  const std::string& name() const;
  /// Whether its work-items run on the host's processor, one after the other in each thread.
  bool is_cpu() const;
  /// Largest single buffer.
  std::size_t max_buffer_bytes() const;
  /// Of all buffers; on a processor that of the host.
  std::size_t memory_bytes() const;

  /// Errors: more than the device's largest buffer (checked before), out of memory.
  Result<DeviceBuffer> allocate(std::size_t bytes, std::string_view purpose);
  /// A buffer that has so many bytes stays: fresh memory costs more than what is written to it. Else it is made anew.
  Status make_room(DeviceBuffer& buffer, std::size_t bytes, std::string_view purpose);
  /// Makes room for the values and writes them.
  template <class T>
  Status fill(DeviceBuffer& buffer, const std::vector<T>& values, std::string_view purpose) {
    if (Status room = make_room(buffer, values.size() * sizeof(T), purpose); !room) return room;
    return write(buffer, 0, std::as_bytes(std::span(values)));
  }
  Status write(const DeviceBuffer& buffer, std::size_t offset, std::span<const std::byte> data);
  Status read(const DeviceBuffer& buffer, std::span<std::byte> data);
  Status zero(const DeviceBuffer& buffer);

  /// Compiles the embedded source `source` and takes one function of it. An Error holds the compiler's log.
  Result<DeviceKernel> build(std::string_view source, const std::string& options, const std::string& function);

  /// Another function of a kernel's source, as built for it.
  Result<DeviceKernel> another(const DeviceKernel& kernel, const std::string& function);

  /// Runs ⌈items/group⌉·group work-items and waits. Gives the kernel's time by OpenCL's profiling, seconds.
  Result<double> run(DeviceKernel& kernel, std::size_t items, std::size_t group);

 private:
  friend Result<std::string> try_opencl();
  struct Impl;
  explicit OpenClDevice(std::unique_ptr<Impl> impl);
  static Result<std::unique_ptr<OpenClDevice>> open();
  Result<DeviceKernel> take(_cl_program* program, const std::string& function) const;
  std::unique_ptr<Impl> impl_;
};

/// Opens the chosen device and runs a small kernel, in this process: what probe_opencl() does in its child.
Result<std::string> try_opencl();

}  // namespace lumifield
