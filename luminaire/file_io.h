#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "luminaire/error.h"

namespace lumifield {

/// Files at the level of the kernel, so that every failing call becomes an Error with its reason and a remedy, and that
/// "written" means "on disk". All functions are reentrant.

/// Owns one file descriptor. Thread-bound.
class FileHandle {
 public:
  FileHandle() = default;
  explicit FileHandle(int fd) : fd_(fd) {}
  FileHandle(FileHandle&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileHandle& operator=(FileHandle&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~FileHandle();
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_ = -1;
};

/// The Error of a system call that failed with `code` (errno): `action` is "could not …"; `kind` = disk_full where
/// the disk, or the owner's share of it, is.
tl::unexpected<Error> system_failure(std::string_view action, const std::filesystem::path& file, int code);

/// The whole of a regular file. Refuses anything that is no regular file, and one larger than `most_bytes` before
/// memory is taken.
Result<std::string> read_file(const std::filesystem::path& file, std::uintmax_t most_bytes);

/// Writes `bytes` as `file` so that it is either there as a whole after a power cut or not at all: temporary name in
/// the same folder, write, fsync, rename, fsync of the folder. On failure nothing is left behind, and the Error names
/// `file`. Refuses to replace what is no regular file: a device, a pipe, a folder.
Status write_file_durably(const std::filesystem::path& file, std::string_view bytes);

/// What write_file_durably would refuse of this name as things are, told before the work whose result it is to hold: a
/// folder that is not there or not writable, and what is no regular file.
Status check_writable(const std::filesystem::path& file);

/// Appends to `file` (made when absent), which holds `length` bytes that count: what lies beyond is cut off first. On
/// disk when this returns; on failure the file is cut back to `length`.
Status append_durably(const std::filesystem::path& file, std::string_view bytes, std::uintmax_t length);

Status cut_file(const std::filesystem::path& file, std::uintmax_t length);

/// Makes the names in a folder durable.
Status sync_folder(const std::filesystem::path& folder);

/// Removes a file; one that is not there is no failure.
Status remove_file(const std::filesystem::path& file);

/// The name under which write_file_durably writes first.
std::filesystem::path temporary_name(const std::filesystem::path& file);

/// `text` as a path below `folder`. Refuses an absolute path, `..`, and a link that leads out of the folder. The file
/// need not exist. `where` stands for the place in messages.
Result<std::filesystem::path> path_inside(const std::filesystem::path& folder, std::string_view text,
                                          std::string_view where);
/// The part of path_inside that needs no disk.
Status check_relative_path(std::string_view text, std::string_view where);

/// SHA-256, lower-case hex.
std::string sha256_hex(std::string_view bytes);

}  // namespace lumifield
