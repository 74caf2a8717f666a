#define FUSE_USE_VERSION 35

#include "acquisition/virtual/video_file.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <fuse_lowlevel.h>
#include <linux/videodev2.h>
#include <list>
#include <poll.h>
#include <sys/uio.h>
#include <thread>
#include <unistd.h>

namespace lumifield::virtual_bench {
namespace {

constexpr fuse_ino_t folder_inode = FUSE_ROOT_ID, file_inode = 2;
constexpr const char* file_name = "video0";
// Mapped beyond a file's end, memory cannot be read: larger than all buffers of the largest sensor.
constexpr off_t file_bytes = off_t{1} << 30;
constexpr double unchanged_s = 3600;

struct stat attributes_of(fuse_ino_t inode) {
  struct stat status {};
  status.st_ino = inode;
  status.st_nlink = 1;
  status.st_mode = inode == folder_inode ? S_IFDIR | 0755 : S_IFREG | 0666;
  status.st_size = inode == folder_inode ? 0 : file_bytes;
  status.st_uid = getuid(), status.st_gid = getgid();
  return status;
}

}  // namespace

struct VideoFile::Impl {
  struct Waiting {
    fuse_req_t request;
    std::uint64_t handle;
    v4l2_buffer buffer;
  };

  V4l2Device& device;
  std::filesystem::path folder;
  fuse_session* session = nullptr;
  bool mounted = false;
  std::mutex mutex;                  // guards what follows; never held while the kernel is told of pages
  std::vector<std::uint8_t> memory;  // what the pages hold, for those that the kernel drops
  std::list<Waiting> waiting;        // blocking DQBUFs
  fuse_pollhandle* polled = nullptr;
  std::uint64_t last_handle = 0;
  int open_handles = 0;
  bool gone = false;
  std::jthread thread;

  explicit Impl(V4l2Device& served) : device(served) {}
  ~Impl() {
    thread = {};  // ends it
    if (polled != nullptr) fuse_pollhandle_destroy(polled);
    if (mounted) fuse_session_unmount(session);
    if (session != nullptr) fuse_session_destroy(session);
    std::error_code ignored;
    std::filesystem::remove(folder, ignored);
  }

  static Impl& of(fuse_req_t request) { return *static_cast<Impl*>(fuse_req_userdata(request)); }

  // The kernel asks one thing at a time of this thread, which never waits for another.
  void serve(std::stop_token stop) {
    fuse_buf buffer{};
    while (!stop.stop_requested() && fuse_session_exited(session) == 0) {
      pollfd readable{fuse_session_fd(session), POLLIN, 0};
      if (::poll(&readable, 1, 20) <= 0) continue;
      const int got = fuse_session_receive_buf(session, &buffer);
      if (got == -EINTR || got == -EAGAIN) continue;
      if (got <= 0) break;
      fuse_session_process_buf(session, &buffer);
    }
    std::free(buffer.mem);
  }

  void answer(fuse_req_t request, unsigned command, const fuse_file_info& file, const void* in, std::size_t in_bytes,
              std::size_t out_bytes) {
    alignas(16) std::uint8_t data[1024] = {};
    if (in_bytes > sizeof data || out_bytes > sizeof data) return void(fuse_reply_err(request, ENOTTY));
    std::memcpy(data, in, in_bytes);
    if (command == VIDIOC_G_EXT_CTRLS || command == VIDIOC_S_EXT_CTRLS || command == VIDIOC_TRY_EXT_CTRLS) {
      const int failure = answer_several(request, command, file, *reinterpret_cast<v4l2_ext_controls*>(data));
      failure != 0 ? fuse_reply_err(request, failure) : fuse_reply_ioctl(request, 0, data, out_bytes);
      return;
    }
    const int failure = device.answer(file.fh, command, data);
    if (failure == V4l2Device::would_block && (file.flags & O_NONBLOCK) != 0)
      fuse_reply_err(request, EAGAIN);
    else if (failure == V4l2Device::would_block)
      wait_for_frame(request, file.fh, *reinterpret_cast<v4l2_buffer*>(data));
    else if (failure != 0)
      fuse_reply_err(request, failure);
    else
      fuse_reply_ioctl(request, 0, data, out_bytes);
    if (command == VIDIOC_STREAMOFF || command == VIDIOC_REQBUFS) notify();
  }

  /// The controls lie in the asking program's memory.
  int answer_several(fuse_req_t request, unsigned command, const fuse_file_info& file, v4l2_ext_controls& all) {
    if (all.count > 64) return EINVAL;
    std::vector<v4l2_ext_control> controls(all.count);
    const iovec here{controls.data(), controls.size() * sizeof(v4l2_ext_control)}, there{all.controls, here.iov_len};
    const pid_t program = fuse_req_ctx(request)->pid;
    if (process_vm_readv(program, &here, 1, &there, 1, 0) != static_cast<ssize_t>(here.iov_len)) return EFAULT;
    for (std::uint32_t i = 0; i < all.count; ++i) {
      v4l2_control control{controls[i].id, controls[i].value};
      const bool sets = command == VIDIOC_S_EXT_CTRLS;
      all.error_idx = i;
      if (const int failure = device.answer(file.fh, sets ? VIDIOC_S_CTRL : VIDIOC_G_CTRL, &control); failure != 0)
        return failure;
      if (command != VIDIOC_TRY_EXT_CTRLS) controls[i].value = control.value;
    }
    return process_vm_writev(program, &here, 1, &there, 1, 0) == static_cast<ssize_t>(here.iov_len) ? 0 : EFAULT;
  }

  void wait_for_frame(fuse_req_t request, std::uint64_t handle, const v4l2_buffer& asked) {
    const std::lock_guard lock(mutex);
    waiting.push_back({request, handle, asked});
  }

  /// Answers those whose frame has come, or who wait in vain.
  void notify() {
    const std::lock_guard lock(mutex);
    for (auto each = waiting.begin(); each != waiting.end();) {
      const bool was_interrupted = fuse_req_interrupted(each->request) != 0;
      const int failure = was_interrupted ? EINTR : device.answer(each->handle, VIDIOC_DQBUF, &each->buffer);
      if (failure == V4l2Device::would_block) {
        ++each;
        continue;
      }
      failure != 0 ? fuse_reply_err(each->request, failure)
                   : fuse_reply_ioctl(each->request, 0, &each->buffer, sizeof each->buffer);
      each = waiting.erase(each);
    }
    if (polled == nullptr) return;
    fuse_lowlevel_notify_poll(polled);
    fuse_pollhandle_destroy(std::exchange(polled, nullptr));
  }

  static void lookup(fuse_req_t request, fuse_ino_t parent, const char* name) {
    const std::lock_guard lock(of(request).mutex);
    if (parent != folder_inode || std::strcmp(name, file_name) != 0 || of(request).gone)
      return void(fuse_reply_err(request, ENOENT));
    fuse_entry_param entry{};
    entry.ino = file_inode;
    entry.attr_timeout = unchanged_s;
    entry.attr = attributes_of(file_inode);
    fuse_reply_entry(request, &entry);
  }
  static void getattr(fuse_req_t request, fuse_ino_t inode, fuse_file_info*) {
    const struct stat status = attributes_of(inode);
    fuse_reply_attr(request, &status, unchanged_s);
  }
  static void setattr(fuse_req_t request, fuse_ino_t inode, struct stat*, int, fuse_file_info* file) {
    getattr(request, inode, file);
  }
  static void open(fuse_req_t request, fuse_ino_t, fuse_file_info* file) {
    Impl& self = of(request);
    const std::lock_guard lock(self.mutex);
    if (self.gone) return void(fuse_reply_err(request, ENODEV));
    file->fh = ++self.last_handle;
    file->keep_cache = 1, file->nonseekable = 1;
    ++self.open_handles;
    fuse_reply_open(request, file);
  }
  static void release(fuse_req_t request, fuse_ino_t, fuse_file_info* file) {
    of(request).device.close(file->fh);
    {
      const std::lock_guard lock(of(request).mutex);
      --of(request).open_handles;
    }
    fuse_reply_err(request, 0);
  }
  static void flush(fuse_req_t request, fuse_ino_t, fuse_file_info*) { fuse_reply_err(request, 0); }
  // Asked for a page that no frame was put into yet, or that the kernel has dropped.
  static void read(fuse_req_t request, fuse_ino_t, std::size_t bytes, off_t offset, fuse_file_info*) {
    Impl& self = of(request);
    std::vector<std::uint8_t> page(bytes);
    const std::lock_guard lock(self.mutex);
    const auto first = static_cast<std::size_t>(offset);
    if (first < self.memory.size())
      std::copy_n(self.memory.begin() + offset, std::min(bytes, self.memory.size() - first), page.begin());
    fuse_reply_buf(request, reinterpret_cast<const char*>(page.data()), bytes);
  }
  static void readdir(fuse_req_t request, fuse_ino_t, std::size_t, off_t, fuse_file_info*) {
    fuse_reply_buf(request, nullptr, 0);
  }
  static void ioctl(fuse_req_t request, fuse_ino_t, unsigned command, void*, fuse_file_info* file, unsigned,
                    const void* in, std::size_t in_bytes, std::size_t out_bytes) {
    of(request).answer(request, command, *file, in, in_bytes, out_bytes);
  }
  static void poll(fuse_req_t request, fuse_ino_t, fuse_file_info* file, fuse_pollhandle* handle) {
    Impl& self = of(request);
    if (handle != nullptr) {
      const std::lock_guard lock(self.mutex);
      if (self.polled != nullptr) fuse_pollhandle_destroy(self.polled);
      self.polled = handle;
    }
    fuse_reply_poll(request, self.device.poll_events(file->fh));
  }
};

Result<std::unique_ptr<VideoFile>> VideoFile::mount(const std::filesystem::path& folder, V4l2Device& device) {
  constexpr const char* remedy =
      "install fuse3, and give this program /dev/fuse (in a container: --device /dev/fuse "
      "--cap-add SYS_ADMIN), or use --camera gige";
  if (access("/dev/fuse", R_OK | W_OK) != 0)
    return fail(std::string("the camera's file cannot be served: ") + std::strerror(errno), "/dev/fuse", remedy);
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) return fail("cannot be made: " + failure.message(), folder.string(), "check the space there");

  auto impl = std::make_unique<Impl>(device);
  impl->folder = folder;
  fuse_lowlevel_ops operations{};
  operations.lookup = Impl::lookup, operations.getattr = Impl::getattr, operations.setattr = Impl::setattr;
  operations.open = Impl::open, operations.release = Impl::release, operations.flush = Impl::flush;
  operations.read = Impl::read, operations.readdir = Impl::readdir;
  operations.ioctl = Impl::ioctl, operations.poll = Impl::poll;
  std::vector<std::string> words{"lumifield-bench", "-ofsname=lumifield-bench"};
  if (geteuid() == 0) words.back() += ",allow_other";
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  fuse_args arguments = FUSE_ARGS_INIT(static_cast<int>(pointers.size()), pointers.data());
  impl->session = fuse_session_new(&arguments, &operations, sizeof operations, impl.get());
  fuse_opt_free_args(&arguments);
  impl->mounted = impl->session != nullptr && fuse_session_mount(impl->session, folder.c_str()) == 0;
  if (!impl->mounted) return fail("the camera's file cannot be mounted", folder.string(), remedy);
  impl->thread = std::jthread([self = impl.get()](std::stop_token stop) { self->serve(stop); });
  return std::unique_ptr<VideoFile>(new VideoFile(std::move(impl)));
}

VideoFile::VideoFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

VideoFile::~VideoFile() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->gone = true;
  }
  fuse_lowlevel_notify_inval_entry(impl_->session, folder_inode, file_name, std::strlen(file_name));
  notify();
  for (int tries = 0; tries < 50; ++tries) {
    {
      const std::lock_guard lock(impl_->mutex);
      if (impl_->open_handles == 0) break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

std::filesystem::path VideoFile::path() const { return impl_->folder / file_name; }

void VideoFile::store(std::uint32_t buffer, std::span<const std::uint8_t> bytes) {
  const std::size_t first = buffer * bytes.size();
  {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->memory.size() < first + bytes.size()) impl_->memory.resize(first + bytes.size());
    std::ranges::copy(bytes, impl_->memory.begin() + static_cast<std::ptrdiff_t>(first));
  }
  fuse_bufvec pages = FUSE_BUFVEC_INIT(bytes.size());
  pages.buf[0].mem = const_cast<std::uint8_t*>(bytes.data());
  fuse_lowlevel_notify_store(impl_->session, file_inode, static_cast<off_t>(first), &pages, fuse_buf_copy_flags{});
}

void VideoFile::notify() { impl_->notify(); }

}  // namespace lumifield::virtual_bench
