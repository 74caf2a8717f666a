#include "app/session/disk_room.h"

#include <sys/stat.h>

namespace lumifield {

Result<DiskRoom> disk_room(const std::filesystem::path& path) {
  std::error_code code;
  std::filesystem::path nearest = std::filesystem::absolute(path, code);
  while (!nearest.empty() && nearest != nearest.root_path() && !std::filesystem::exists(nearest, code))
    nearest = nearest.parent_path();
  const std::filesystem::space_info space = std::filesystem::space(nearest, code);
  if (code)
    return fail("the disk's room cannot be read: " + code.message(), path.string(), "check that the disk is mounted");
  struct stat status {};
  if (::stat(nearest.c_str(), &status) != 0)
    return fail("is on a disk that does not tell which one it is", path.string(), "check that the disk is mounted");
  return DiskRoom{static_cast<double>(space.available), status.st_dev};
}

}  // namespace lumifield
