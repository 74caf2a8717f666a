#include "app/session/disk_room.h"

#include <filesystem>
#include <gtest/gtest.h>

namespace lumifield {
namespace {

TEST(DiskRoom, OfAPathThatIsNotThereYetIsItsNearestFoldersOwn) {
  const auto here = disk_room(std::filesystem::temp_directory_path());
  ASSERT_TRUE(here) << here.error().message();
  EXPECT_GT(here->free_bytes, 0);
  const auto below = disk_room(std::filesystem::temp_directory_path() / "not/there/yet.lumi");
  ASSERT_TRUE(below) << below.error().message();
  EXPECT_TRUE(share_room(*below, *here));
}

TEST(DiskRoom, TellsDisksApart) {
  const auto here = disk_room(std::filesystem::temp_directory_path()), other = disk_room("/proc/not there");
  ASSERT_TRUE(here && other);
  EXPECT_FALSE(share_room(*here, *other));
}

TEST(DiskRoom, VolumesOfOneFileSystemShareIt) {
  const DiskRoom volume{1e9, 40, true}, other_volume{1e9, 41, true}, fuller{5e8, 42, true}, disk{1e9, 43, false};
  EXPECT_TRUE(share_room(volume, other_volume));
  EXPECT_FALSE(share_room(volume, fuller));
  EXPECT_FALSE(share_room(volume, disk));
  EXPECT_FALSE(share_room(disk, {1e9, 44, false})) << "two disks may have as many bytes free";
  EXPECT_TRUE(share_room(disk, {5e8, 43, false})) << "written to in between";
}

TEST(DiskRoom, OfARelativePathIsThatOfTheCurrentFolder) {
  const auto here = disk_room(std::filesystem::current_path()), relative = disk_room("scans/lamp.lumi");
  ASSERT_TRUE(here && relative);
  EXPECT_TRUE(share_room(*here, *relative));
}

}  // namespace
}  // namespace lumifield
