#include "luminaire/file_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lumifield {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(FileIo, ReplacesRegularFilesAlone) {
  const fs::path folder = fs::path(testing::TempDir()) / ("file_io_" + std::to_string(getpid()));
  fs::create_directories(folder / "folder");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  fs::create_symlink("/dev/null", folder / "device");
  for (const char* name : {"folder", "pipe", "device"}) {
    const fs::file_type before = fs::symlink_status(folder / name).type();
    const Status written = write_file_durably(folder / name, "text");
    ASSERT_FALSE(written) << name;
    EXPECT_THAT(written.error().message(), HasSubstr("is no regular file"));
    EXPECT_EQ(fs::symlink_status(folder / name).type(), before) << name;
    EXPECT_FALSE(fs::exists(temporary_name(folder / name))) << name;
  }

  for (const char* text : {"first", "second"}) {
    ASSERT_TRUE(write_file_durably(folder / "file", text));
    EXPECT_EQ(read_file(folder / "file", 100).value(), text);
  }
  fs::remove_all(folder);
}

TEST(FileIo, TellsBeforehandWhatCouldNotBeWritten) {
  const fs::path folder = fs::path(testing::TempDir()) / ("file_io_before_" + std::to_string(getpid()));
  fs::create_directories(folder / "folder");
  ASSERT_TRUE(write_file_durably(folder / "file", "text"));
  EXPECT_TRUE(check_writable(folder / "file"));
  EXPECT_TRUE(check_writable(folder / "new"));
  EXPECT_FALSE(fs::exists(folder / "new"));
  EXPECT_TRUE(check_writable("new_in_this_folder"));
  // As the writing itself says.
  for (const char* name : {"folder", "nowhere/file", "file/file"}) {
    const Status told = check_writable(folder / name), written = write_file_durably(folder / name, "text");
    ASSERT_FALSE(told || written) << name;
    EXPECT_EQ(told.error().message(), written.error().message());
  }
  fs::remove_all(folder);
}

TEST(FileIo, NamesTheFileAndNotItsTemporaryName) {
  const Status written = write_file_durably("/nowhere/file", "text");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().where, "/nowhere/file");
}

}  // namespace
}  // namespace lumifield
