#define CL_TARGET_OPENCL_VERSION 120
#include "renderer/opencl/device.h"

#include <CL/cl.h>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <vector>

#include "renderer/opencl/kernel_source.h"
#include "renderer/opencl/probe.h"
#include "renderer/renderer.h"

namespace lumifield {

namespace {

constexpr const char* choose_another = "choose another device with LUMIFIELD_OPENCL (a part of its name)";

tl::unexpected<Error> failed(const std::string& action, int code, const std::string& where) {
  return fail(action + " failed with OpenCL error " + std::to_string(code), where, choose_another);
}

std::string text_of(cl_device_id device, cl_device_info info) {
  std::size_t bytes = 0;
  clGetDeviceInfo(device, info, 0, nullptr, &bytes);
  std::string text(bytes, '\0');
  if (clGetDeviceInfo(device, info, bytes, text.data(), nullptr) != CL_SUCCESS) return {};
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

template <class T>
T number_of(cl_device_id device, cl_device_info info) {
  T value = 0;
  clGetDeviceInfo(device, info, sizeof value, &value, nullptr);
  return value;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

Result<std::vector<cl_device_id>> all_devices() {
  cl_uint count = 0;
  const int code = clGetPlatformIDs(0, nullptr, &count);
  std::vector<cl_platform_id> platforms(count);
  if (code != CL_SUCCESS || count == 0 || clGetPlatformIDs(count, platforms.data(), nullptr) != CL_SUCCESS)
    return fail("no OpenCL platform is installed", "OpenCL", "install a driver (package pocl-opencl-icd)");
  std::vector<cl_device_id> devices;
  for (cl_platform_id platform : platforms) {
    cl_uint found = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &found) != CL_SUCCESS) continue;
    const std::size_t before = devices.size();
    devices.resize(before + found);
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, found, devices.data() + before, nullptr) != CL_SUCCESS)
      devices.resize(before);
  }
  if (devices.empty())
    return fail("no OpenCL driver offers a device", "OpenCL", "install a driver (package pocl-opencl-icd)");
  return devices;
}

Result<cl_device_id> choose_device() {
  auto devices = all_devices();
  if (!devices) return tl::unexpected(devices.error());
  const auto has_double = [](cl_device_id d) {
    return number_of<cl_device_fp_config>(d, CL_DEVICE_DOUBLE_FP_CONFIG) != 0;
  };
  if (const char* wanted = std::getenv("LUMIFIELD_OPENCL"); wanted && *wanted) {
    for (cl_device_id device : *devices) {
      const std::string name = text_of(device, CL_DEVICE_NAME);
      if (lower(name).find(lower(wanted)) == std::string::npos) continue;
      if (!has_double(device)) return fail("does not compute in double precision", name, choose_another);
      return device;
    }
    std::string names;
    for (cl_device_id device : *devices) names += (names.empty() ? "" : ", ") + text_of(device, CL_DEVICE_NAME);
    return fail("no OpenCL device has \"" + std::string(wanted) + "\" in its name", "LUMIFIELD_OPENCL",
                "there is: " + names);
  }
  std::erase_if(*devices, [&](cl_device_id d) { return !has_double(d); });
  if (devices->empty())
    return fail("no device computes in double precision", "OpenCL", "install another driver (package pocl-opencl-icd)");
  for (cl_device_id device : *devices)
    if (number_of<cl_device_type>(device, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_GPU) return device;
  return devices->front();
}

}  // namespace

struct OpenClDevice::Impl {
  cl_device_id device = nullptr;
  std::shared_ptr<_cl_context> context;
  std::shared_ptr<_cl_command_queue> queue;
  std::string name;
  std::size_t max_buffer_bytes = 0, memory_bytes = 0;
  bool is_cpu = false;
};

OpenClDevice::OpenClDevice(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OpenClDevice::~OpenClDevice() = default;
const std::string& OpenClDevice::name() const { return impl_->name; }
bool OpenClDevice::is_cpu() const { return impl_->is_cpu; }
std::size_t OpenClDevice::max_buffer_bytes() const { return impl_->max_buffer_bytes; }
std::size_t OpenClDevice::memory_bytes() const { return impl_->memory_bytes; }

Result<std::unique_ptr<OpenClDevice>> OpenClDevice::create() {
  if (auto probed = probe_opencl(); !probed) return tl::unexpected(probed.error());
  note_opencl_in_use();
  return open();
}

Result<std::unique_ptr<OpenClDevice>> OpenClDevice::open() {
  const auto device = choose_device();
  if (!device) return tl::unexpected(device.error());
  auto impl = std::make_unique<Impl>();
  impl->device = *device;
  impl->name = text_of(*device, CL_DEVICE_NAME);
  impl->max_buffer_bytes = number_of<cl_ulong>(*device, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
  impl->memory_bytes = number_of<cl_ulong>(*device, CL_DEVICE_GLOBAL_MEM_SIZE);
  impl->is_cpu = (number_of<cl_device_type>(*device, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_CPU) != 0;
  int code = 0;
  impl->context.reset(clCreateContext(nullptr, 1, &impl->device, nullptr, nullptr, &code), [](cl_context c) {
    if (c) clReleaseContext(c);
  });
  if (code != CL_SUCCESS) return failed("opening the device", code, impl->name);
  impl->queue.reset(clCreateCommandQueue(impl->context.get(), *device, CL_QUEUE_PROFILING_ENABLE, &code),
                    [](cl_command_queue q) {
                      if (q) clReleaseCommandQueue(q);
                    });
  if (code != CL_SUCCESS) return failed("making a queue", code, impl->name);
  return std::unique_ptr<OpenClDevice>(new OpenClDevice(std::move(impl)));
}

Result<DeviceBuffer> OpenClDevice::allocate(std::size_t bytes, std::string_view purpose) {
  const auto refuse = [&](const std::string& why) {
    return fail(std::to_string(bytes) + " bytes for " + std::string(purpose) + " " + why, name(), choose_another);
  };
  if (bytes > impl_->max_buffer_bytes)
    return refuse("exceed the device's largest buffer, " + std::to_string(impl_->max_buffer_bytes));
  DeviceBuffer buffer;
  buffer.bytes_ = std::max<std::size_t>(bytes, 1);
  int code = 0;
  buffer.handle_.reset(clCreateBuffer(impl_->context.get(), CL_MEM_READ_WRITE, buffer.bytes_, nullptr, &code),
                       [](cl_mem m) {
                         if (m) clReleaseMemObject(m);
                       });
  if (code != CL_SUCCESS) return refuse("could not be had (OpenCL error " + std::to_string(code) + ")");
  return buffer;
}

Status OpenClDevice::make_room(DeviceBuffer& buffer, std::size_t bytes, std::string_view purpose) {
  if (buffer.bytes() >= bytes && buffer.bytes() > 0) return {};
  buffer = {};
  auto more = allocate(bytes, purpose);
  if (!more) return tl::unexpected(more.error());
  buffer = *more;
  return {};
}

Status OpenClDevice::write(const DeviceBuffer& buffer, std::size_t offset, std::span<const std::byte> data) {
  if (data.empty()) return {};
  const int code = clEnqueueWriteBuffer(impl_->queue.get(), buffer.handle_.get(), CL_TRUE, offset, data.size(),
                                        data.data(), 0, nullptr, nullptr);
  if (code != CL_SUCCESS) return failed("writing to the device", code, name());
  return {};
}

Status OpenClDevice::read(const DeviceBuffer& buffer, std::span<std::byte> data) {
  if (data.empty()) return {};
  const int code = clEnqueueReadBuffer(impl_->queue.get(), buffer.handle_.get(), CL_TRUE, 0, data.size(), data.data(),
                                       0, nullptr, nullptr);
  if (code != CL_SUCCESS) return failed("reading from the device", code, name());
  return {};
}

Status OpenClDevice::zero(const DeviceBuffer& buffer) {
  const unsigned char nothing = 0;
  int code = clEnqueueFillBuffer(impl_->queue.get(), buffer.handle_.get(), &nothing, 1, 0, buffer.bytes(), 0, nullptr,
                                 nullptr);
  if (code == CL_SUCCESS) code = clFinish(impl_->queue.get());
  if (code != CL_SUCCESS) return failed("clearing a buffer", code, name());
  return {};
}

Result<DeviceKernel> OpenClDevice::build(std::string_view source, const std::string& options,
                                         const std::string& function) {
  const auto text = kernel_source(source);
  if (!text) return tl::unexpected(text.error());
  int code = 0;
  const char* begin = text->text.c_str();
  std::shared_ptr<_cl_program> program(clCreateProgramWithSource(impl_->context.get(), 1, &begin, nullptr, &code),
                                       [](cl_program p) {
                                         if (p) clReleaseProgram(p);
                                       });
  if (code != CL_SUCCESS) return failed("loading kernel " + std::string(source), code, name());

  const std::string all_options = "-cl-std=CL1.2 " + options + " " + text->options;
  if (clBuildProgram(program.get(), 1, &impl_->device, all_options.c_str(), nullptr, nullptr) != CL_SUCCESS) {
    std::size_t bytes = 0;
    clGetProgramBuildInfo(program.get(), impl_->device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes);
    std::string log(bytes, '\0');
    clGetProgramBuildInfo(program.get(), impl_->device, CL_PROGRAM_BUILD_LOG, bytes, log.data(), nullptr);
    log.resize(std::min(log.find('\0'), log.size()));
    return fail("kernel " + std::string(source) + " does not build: " + log, name(), choose_another);
  }
  return take(program.get(), function);
}

Result<DeviceKernel> OpenClDevice::another(const DeviceKernel& kernel, const std::string& function) {
  cl_program program = nullptr;
  const int code = clGetKernelInfo(kernel.handle_.get(), CL_KERNEL_PROGRAM, sizeof program, &program, nullptr);
  if (code != CL_SUCCESS) return failed("taking kernel " + function, code, name());
  return take(program, function);
}

Result<DeviceKernel> OpenClDevice::take(_cl_program* program, const std::string& function) const {
  DeviceKernel kernel;
  kernel.name_ = function;
  int code = 0;
  kernel.handle_.reset(clCreateKernel(program, function.c_str(), &code), [](cl_kernel k) {
    if (k) clReleaseKernel(k);
  });
  if (code != CL_SUCCESS) return failed("taking kernel " + function, code, name());
  return kernel;
}

void DeviceKernel::set(unsigned number, const DeviceBuffer& buffer) {
  const cl_mem memory = buffer.handle_.get();
  set_bytes(number, &memory, sizeof memory);
}

void DeviceKernel::set_bytes(unsigned number, const void* value, std::size_t bytes) {
  const int code = clSetKernelArg(handle_.get(), number, bytes, value);
  if (code == CL_SUCCESS)
    errors_.erase(number);
  else
    errors_[number] = code;
}

Result<double> OpenClDevice::run(DeviceKernel& kernel, std::size_t items, std::size_t group) {
  if (!kernel.errors_.empty()) {
    const auto& [number, code] = *kernel.errors_.begin();
    return failed("setting argument " + std::to_string(number) + " of " + kernel.name_, code, name());
  }
  if (items == 0) return 0.0;
  const std::size_t global = (items + group - 1) / group * group;
  cl_event done = nullptr;
  int code =
      clEnqueueNDRangeKernel(impl_->queue.get(), kernel.handle_.get(), 1, nullptr, &global, &group, 0, nullptr, &done);
  if (code != CL_SUCCESS) return failed("running " + kernel.name_, code, name());
  code = clWaitForEvents(1, &done);
  cl_ulong start = 0, end = 0;
  if (code == CL_SUCCESS)
    code = clGetEventProfilingInfo(done, CL_PROFILING_COMMAND_START, sizeof start, &start, nullptr);
  if (code == CL_SUCCESS) code = clGetEventProfilingInfo(done, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr);
  clReleaseEvent(done);
  if (code != CL_SUCCESS) return failed("running " + kernel.name_, code, name());
  return static_cast<double>(end - start) * 1e-9;
}

Result<std::string> try_opencl() {
  auto device = OpenClDevice::open();
  if (!device) return tl::unexpected(device.error());
  auto kernel = (*device)->build("probe", "", "probe");
  if (!kernel) return tl::unexpected(kernel.error());
  auto buffer = (*device)->allocate(sizeof(double), "the probe");
  if (!buffer) return tl::unexpected(buffer.error());
  kernel->set(0, *buffer);
  kernel->set(1, 20.5);
  if (auto ran = (*device)->run(*kernel, 1, 1); !ran) return tl::unexpected(ran.error());
  double value = 0;
  if (auto got = (*device)->read(*buffer, std::as_writable_bytes(std::span(&value, 1))); !got)
    return tl::unexpected(got.error());
  if (value != 42) return fail("a small kernel gave a wrong result", (*device)->name(), choose_another);
  return (*device)->name() + ", " + text_of((*device)->impl_->device, CL_DEVICE_VERSION);
}

}  // namespace lumifield
