#pragma once

#include <filesystem>
#include <sys/types.h>

#include "luminaire/error.h"

namespace lumifield {

/// A disk, as far as it matters to what is to be stored on it. Value type.
struct DiskRoom {
  double free_bytes = 0;  ///< that this user may still write
  dev_t device = 0;       ///< of two paths on one file system the same, but for volumes of one that has several (btrfs)
  bool has_volumes = false;
};

/// Whether what is written on one leaves less for the other. Volumes of one file system have different devices, but
/// the same bytes free; two such file systems that happen to have as many free count as one.
bool share_room(const DiskRoom& a, const DiskRoom& b);

/// Of the disk on which a path lies, or will: one that is not there yet counts as its nearest folder that is. Blocks
/// for as long as a file server hangs; reentrant. Errors: the disk does not tell.
Result<DiskRoom> disk_room(const std::filesystem::path& path);

}  // namespace lumifield
