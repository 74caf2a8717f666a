#include "luminaire/file_io.h"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace lumifield {
namespace fs = std::filesystem;
namespace {

constexpr mode_t file_mode = 0666;

std::string_view remedy_of(int code) {
  switch (code) {
    case ENOSPC:
    case EDQUOT:
      return "free space on that disk, then go on with --resume";
    case EROFS:
      return "the disk is mounted read-only: choose another folder or mount it writable";
    case EACCES:
    case EPERM:
      return "give yourself permission, or choose another folder";
    case EIO:
      return "the disk reports a fault: check it and its cable before going on";
    case ENOENT:
      return "check the path";
    case ENOTDIR:
      return "a part of the path is no folder: check the path";
    case EISDIR:
      return "give a file, not a folder";
    case ENAMETOOLONG:
      return "choose a shorter path";
    case EMFILE:
    case ENFILE:
      return "too many files are open: close other programs";
    default:
      return "check the path and its disk";
  }
}

int open_retrying(const fs::path& file, int flags, mode_t mode = 0) {
  int fd;
  do fd = ::open(file.c_str(), flags | O_CLOEXEC, mode);
  while (fd < 0 && errno == EINTR);
  return fd;
}

/// 0 or errno.
int write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n > 0)
      bytes.remove_prefix(static_cast<std::size_t>(n));
    else if (n == 0)
      return EIO;
    else if (errno != EINTR)
      return errno;
  }
  return 0;
}

/// 0 or errno.
int sync_and_close(FileHandle handle) {
  if (::fsync(handle.get()) != 0) return errno;
  return ::close(handle.release()) != 0 && errno != EINTR ? errno : 0;
}

fs::path folder_of(const fs::path& file) {
  const fs::path parent = file.parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

/// The rename would put a file in the place of a device or a pipe.
Status check_replaceable(const fs::path& file) {
  struct stat old {};
  if (::stat(file.c_str(), &old) == 0 && !S_ISREG(old.st_mode))
    return fail("is no regular file", file.string(), "choose another name");
  return {};
}

}  // namespace

FileHandle::~FileHandle() {
  if (fd_ >= 0) ::close(fd_);
}

tl::unexpected<Error> system_failure(std::string_view action, const fs::path& file, int code) {
  const bool full = code == ENOSPC || code == EDQUOT;
  return tl::unexpected<Error>({std::string(action) + ": " + std::generic_category().message(code), file.string(),
                                std::string(remedy_of(code)), full ? ErrorKind::disk_full : ErrorKind::fault});
}

Result<std::string> read_file(const fs::path& file, std::uintmax_t most_bytes) {
  // O_NONBLOCK: opening a FIFO must not wait for its writer.
  const FileHandle handle(open_retrying(file, O_RDONLY | O_NONBLOCK));
  if (!handle) return system_failure("could not be opened", file, errno);
  struct stat status {};
  if (::fstat(handle.get(), &status) != 0) return system_failure("could not be examined", file, errno);
  if (!S_ISREG(status.st_mode)) return fail("is no regular file", file.string(), "give a file");
  const auto bytes = static_cast<std::uintmax_t>(status.st_size);
  if (bytes > most_bytes)
    return fail("holds " + std::to_string(bytes) + " bytes, more than the " + std::to_string(most_bytes) + " allowed",
                file.string(), "check that it is the right file");
  std::string text(static_cast<std::size_t>(bytes), '\0');
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = ::read(handle.get(), text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_failure("could not be read", file, errno);
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  text.resize(done);
  return text;
}

fs::path temporary_name(const fs::path& file) { return fs::path(file) += ".tmp"; }

Status check_writable(const fs::path& file) {
  if (Status replaceable = check_replaceable(file); !replaceable) return replaceable;
  const fs::path folder = folder_of(file);
  struct stat status {};
  const bool there = ::stat(folder.c_str(), &status) == 0;
  if (there && !S_ISDIR(status.st_mode)) return system_failure("could not be made", file, ENOTDIR);
  if (!there || ::access(folder.c_str(), W_OK | X_OK) != 0) return system_failure("could not be made", file, errno);
  return {};
}

Status write_file_durably(const fs::path& file, std::string_view bytes) {
  if (Status replaceable = check_replaceable(file); !replaceable) return replaceable;
  const fs::path temporary = temporary_name(file);
  FileHandle handle(open_retrying(temporary, O_WRONLY | O_CREAT | O_TRUNC, file_mode));
  if (!handle) return system_failure("could not be made", file, errno);
  int code = write_all(handle.get(), bytes);
  if (code == 0) code = sync_and_close(std::move(handle));
  if (code == 0 && ::rename(temporary.c_str(), file.c_str()) != 0) code = errno;
  if (code != 0) {
    ::unlink(temporary.c_str());
    return system_failure("could not be written", file, code);
  }
  return sync_folder(folder_of(file));
}

Status append_durably(const fs::path& file, std::string_view bytes, std::uintmax_t length) {
  FileHandle handle(open_retrying(file, O_WRONLY | O_CREAT | O_APPEND, file_mode));
  if (!handle) return system_failure("could not be opened for appending", file, errno);
  const auto cut = static_cast<off_t>(length);
  struct stat status {};
  if (::fstat(handle.get(), &status) != 0) return system_failure("could not be examined", file, errno);
  if (status.st_size > cut && ::ftruncate(handle.get(), cut) != 0)
    return system_failure("its torn end could not be cut off", file, errno);
  int code = write_all(handle.get(), bytes);
  if (code == 0 && ::fsync(handle.get()) != 0) code = errno;
  const Status named = code == 0 && length == 0 ? sync_folder(folder_of(file)) : Status{};
  if (code != 0 || !named) {
    // The next append cuts again should this fail too.
    if (::ftruncate(handle.get(), cut) == 0) ::fsync(handle.get());
    if (!named) return named;
    return system_failure("could not be appended to", file, code);
  }
  return {};
}

Status cut_file(const fs::path& file, std::uintmax_t length) {
  FileHandle handle(open_retrying(file, O_WRONLY));
  if (!handle) return system_failure("could not be opened for writing", file, errno);
  if (::ftruncate(handle.get(), static_cast<off_t>(length)) != 0)
    return system_failure("could not be cut", file, errno);
  if (const int code = sync_and_close(std::move(handle))) return system_failure("could not be cut", file, code);
  return {};
}

Status sync_folder(const fs::path& folder) {
  FileHandle handle(open_retrying(folder, O_RDONLY | O_DIRECTORY));
  if (!handle) return system_failure("could not be opened", folder, errno);
  if (const int code = sync_and_close(std::move(handle)))
    return system_failure("could not be flushed to the disk", folder, code);
  return {};
}

Status remove_file(const fs::path& file) {
  if (::unlink(file.c_str()) != 0 && errno != ENOENT) return system_failure("could not be removed", file, errno);
  return {};
}

Status check_relative_path(std::string_view text, std::string_view where) {
  constexpr std::string_view remedy = "give a path below the folder of the file";
  const auto refuse = [&](std::string_view what) {
    return fail(std::string(what), std::string(where), std::string(remedy));
  };
  if (text.empty()) return refuse("is an empty path");
  if (text.size() > 4096) return refuse("is a path of more than 4096 bytes");
  if (text.find('\0') != std::string_view::npos) return refuse("is a path with a NUL character");
  const fs::path path{std::string(text)};
  if (path.is_absolute()) return refuse("is an absolute path");
  for (const fs::path& part : path)
    if (part == "..") return refuse("leads out of the folder");
  return {};
}

Result<fs::path> path_inside(const fs::path& folder, std::string_view text, std::string_view where) {
  if (Status ok = check_relative_path(text, where); !ok) return tl::unexpected(ok.error());
  const fs::path joined = folder / fs::path{std::string(text)}.lexically_normal();
  std::error_code code;
  const fs::path root = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, code);
  const fs::path target = code ? fs::path() : fs::weakly_canonical(joined, code);
  if (code) return system_failure("could not be followed", joined, code.value());
  // A link inside the folder may lead anywhere: compare where both end.
  auto rest = target.begin();
  for (const fs::path& part : root) {
    if (part.empty()) continue;
    if (rest == target.end() || *rest != part)
      return fail("is a link that leads out of the folder", std::string(where), "copy the file into the folder");
    ++rest;
  }
  return joined;
}

std::string sha256_hex(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1) return {};
  constexpr std::string_view digits = "0123456789abcdef";
  std::string hex;
  for (unsigned int k = 0; k < length; ++k) {
    hex += digits[digest[k] >> 4];
    hex += digits[digest[k] & 15];
  }
  return hex;
}

}  // namespace lumifield
