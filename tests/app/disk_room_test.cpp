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
  EXPECT_EQ(below->device, here->device);
}

TEST(DiskRoom, TellsDisksApart) {
  const auto here = disk_room(std::filesystem::temp_directory_path()), other = disk_room("/proc/not there");
  ASSERT_TRUE(here && other);
  EXPECT_NE(here->device, other->device);
}

TEST(DiskRoom, OfARelativePathIsThatOfTheCurrentFolder) {
  const auto here = disk_room(std::filesystem::current_path()), relative = disk_room("scans/lamp.lumi");
  ASSERT_TRUE(here && relative);
  EXPECT_EQ(here->device, relative->device);
}

}  // namespace
}  // namespace lumifield
