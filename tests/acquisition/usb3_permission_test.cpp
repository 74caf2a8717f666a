#include "acquisition/cameras/usb3_permission.h"

#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/dataset_folder.h"

namespace lumifield {
namespace {
namespace fs = std::filesystem;

/// A camera, its serial port's chip and a mouse, as sysfs shows them.
class Usb3Permission : public support::TemporaryFolder {
 protected:
  Usb3Permission() {
    add("1-2", 4, "1-2:1.0", "ef", "05");
    add("1-3", 5, "1-3:1.0", "ff", "00");
    add("1-4", 6, "1-4:1.0", "03", "01");
    for (const fs::path& folder : {folder_, sysfs_, nodes_, nodes_ / "001"}) fs::permissions(folder, fs::perms(0755));
  }
  void add(const std::string& device, int number, const std::string& interface, const char* of_class,
           const char* subclass) {
    fs::create_directories(sysfs_ / device);
    fs::create_directories(sysfs_ / interface);
    fs::create_directories(nodes_ / "001");
    const auto write = [](const fs::path& file, const std::string& text) { std::ofstream(file) << text << '\n'; };
    write(sysfs_ / device / "busnum", "1");
    write(sysfs_ / device / "devnum", std::to_string(number));
    write(sysfs_ / device / "manufacturer", "Maker");
    write(sysfs_ / device / "product", "Model " + device);
    write(sysfs_ / device / "serial", "0815");
    write(sysfs_ / interface / "bInterfaceClass", of_class);
    write(sysfs_ / interface / "bInterfaceSubClass", subclass);
    const fs::path node = nodes_ / "001" / ("00" + std::to_string(number));
    write(node, "");
    fs::permissions(node, fs::perms(0600));
  }
  std::vector<DeviceReport> found() const { return usb3_cameras_without_permission(sysfs_, nodes_); }

  const fs::path sysfs_ = folder_ / "sys", nodes_ = folder_ / "dev";
};

TEST_F(Usb3Permission, WhoMayOpenThemHearsNothing) { EXPECT_TRUE(found().empty()); }

TEST_F(Usb3Permission, WhoMayNotHearsWhichAndWhatToDo) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can be somebody else";
  const auto as_nobody = [&] {
    if (setuid(65534) != 0) _exit(2);
    const std::vector<DeviceReport> reports = found();
    if (reports.size() == 1)
      std::fprintf(stderr, "%s: %s; %s", reports[0].name.c_str(), reports[0].reason.c_str(), reports[0].remedy.c_str());
    _exit(reports.size() == 1 && !reports[0].usable && reports[0].address == nodes_ / "001/004" ? 0 : 1);
  };
  EXPECT_EXIT(as_nobody(), testing::ExitedWithCode(0),
              "Maker Model 1-2 0815: no permission to open it; .*setup --udev");
}

TEST_F(Usb3Permission, NoUsbAtAllIsNone) {
  EXPECT_TRUE(usb3_cameras_without_permission(folder_ / "nowhere", nodes_).empty());
}

}  // namespace
}  // namespace lumifield
