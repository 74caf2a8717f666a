#include "acquisition/cameras/v4l2_node.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <grp.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

namespace lumifield {
namespace {

namespace fs = std::filesystem;

constexpr const char* look_for_it = "check cable and power; `lumifield devices` lists what answers";

std::string first_line(const fs::path& file) {
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  return line;
}

/// "NAME (process N)" of other programs that have the path open, as far as /proc tells.
std::string holders_of(const std::string& path) {
  std::string names;
  std::error_code ignored;
  const fs::path wanted = fs::canonical(path, ignored);
  for (const fs::directory_entry& process : fs::directory_iterator("/proc", ignored)) {
    const std::string id = process.path().filename();
    if (id.find_first_not_of("0123456789") != std::string::npos || id == std::to_string(getpid())) continue;
    for (const fs::directory_entry& file : fs::directory_iterator(process.path() / "fd", ignored)) {
      if (fs::read_symlink(file.path(), ignored) != wanted) continue;
      names += (names.empty() ? "" : ", ") + first_line(process.path() / "comm") + " (process " + id + ")";
      break;
    }
  }
  return names;
}

tl::unexpected<Error> held(const std::string& path) {
  const std::string holders = holders_of(path);
  return fail("held by another program" + (holders.empty() ? "" : ": " + holders), "camera " + path,
              "close the other program");
}

tl::unexpected<Error> not_opened(const std::string& path, int failure) {
  const std::string where = "camera " + path;
  if (failure == ENOENT) return fail("no camera answers: there is no such device", where, look_for_it);
  if (means_gone(failure)) return fail("no camera answers", where, look_for_it);
  if (failure == EBUSY) return held(path);
  if (failure != EACCES && failure != EPERM)
    return fail(std::string("cannot be opened (") + std::strerror(failure) + ")", where, look_for_it);
  struct stat status {};
  const group* owner = stat(path.c_str(), &status) == 0 ? getgrgid(status.st_gid) : nullptr;
  return fail("no permission to open it", where,
              "join the group that may (sudo usermod -aG " + std::string(owner != nullptr ? owner->gr_name : "video") +
                  " $USER, then log in again), or give it one by a udev rule: SUBSYSTEM==\"video4linux\", "
                  "GROUP=\"video\", MODE=\"0660\"");
}

}  // namespace

bool means_gone(int failure) {
  return failure == ENODEV || failure == ENXIO || failure == ENOTCONN || failure == ECONNABORTED;
}

Result<V4l2Node> V4l2Node::open(const std::string& path) {
  V4l2Node node(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY), path);
  if (node.descriptor_ < 0) return not_opened(path, errno);
  if (Status identified = node.identify(); !identified) return tl::unexpected(identified.error());
  return node;
}

V4l2Node::~V4l2Node() {
  if (descriptor_ >= 0) close(descriptor_);
}

int V4l2Node::call(unsigned long request, void* argument) const {
  while (ioctl(descriptor_, request, argument) != 0)
    if (errno != EINTR) return errno;
  return 0;
}

int V4l2Node::check() const {
  v4l2_capability capability{};
  return call(VIDIOC_QUERYCAP, &capability);
}

Status V4l2Node::identify() {
  v4l2_capability told{};
  if (const int failure = call(VIDIOC_QUERYCAP, &told); means_gone(failure))
    return not_opened(path_, failure);
  else if (failure != 0)
    return error("is no camera: it does not answer as a V4L2 device",
                 "give a path such as /dev/video0; `lumifield devices` lists what answers");
  const auto text = [](const auto& field) {
    return std::string(reinterpret_cast<const char*>(field),
                       strnlen(reinterpret_cast<const char*>(field), sizeof field));
  };
  driver_ = text(told.driver), model_ = text(told.card), bus_ = text(told.bus_info);
  const std::uint32_t can = (told.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? told.device_caps : told.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 && (can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0)
    return error("gives its pictures in several planes, which is not supported",
                 "use a camera with single-plane pictures");
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0)
    return error("is no camera: no pictures are captured there", "a camera may have several /dev/video*: try the next");
  if ((can & V4L2_CAP_STREAMING) == 0) return error("does not stream pictures into memory", "use another camera");
  return {};
}

std::string V4l2Node::bus_property(const char* name) const {
  struct stat status {};
  if (fstat(descriptor_, &status) != 0 || !S_ISCHR(status.st_mode)) return {};
  std::error_code ignored;
  fs::path device = fs::canonical("/sys/dev/char/" + std::to_string(major(status.st_rdev)) + ":" +
                                      std::to_string(minor(status.st_rdev)) + "/device",
                                  ignored);
  // A USB interface's parent is the device that has a serial number.
  for (int up = 0; up < 3 && device.has_relative_path(); ++up, device = device.parent_path())
    if (const std::string line = first_line(device / name); !line.empty()) return line;
  return {};
}

std::string V4l2Node::serial() const {
  const std::string serial = bus_property("serial");
  return serial.empty() ? bus_ : serial;
}

std::string V4l2Node::vendor() const {
  const std::string maker = bus_property("manufacturer");
  return maker.empty() ? driver_ : maker;
}

tl::unexpected<Error> V4l2Node::refused(const std::string& what, int failure) const {
  if (means_gone(failure)) return error("camera gone: its link was lost", "check cable and power");
  if (failure == EBUSY) return held(path_);
  return error("does not take " + what + " (" + std::strerror(failure) + ")",
               "check the bench file and the camera's manual");
}

}  // namespace lumifield
