#include "app/session/disk_room.h"

#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>

namespace lumifield {

bool share_room(const DiskRoom& a, const DiskRoom& b) {
  return a.device == b.device || (a.has_volumes && b.has_volumes && a.free_bytes == b.free_bytes);
}

Result<DiskRoom> disk_room(const std::filesystem::path& path) {
  std::error_code code;
  std::filesystem::path nearest = std::filesystem::absolute(path, code);
  while (!nearest.empty() && nearest != nearest.root_path() && !std::filesystem::exists(nearest, code))
    nearest = nearest.parent_path();
  const std::filesystem::space_info space = std::filesystem::space(nearest, code);
  if (code)
    return fail("the disk's room cannot be read: " + code.message(), path.string(), "check that the disk is mounted");
  struct stat status {};
  struct statfs system {};
  if (::stat(nearest.c_str(), &status) != 0 || ::statfs(nearest.c_str(), &system) != 0)
    return fail("is on a disk that does not tell which one it is", path.string(), "check that the disk is mounted");
  return DiskRoom{static_cast<double>(space.available), status.st_dev, system.f_type == BTRFS_SUPER_MAGIC};
}

}  // namespace lumifield
