#include "acquisition/virtual/usb_bus.h"

#include <cstdlib>
#include <dlfcn.h>
#include <umockdev.h>
#include <unistd.h>

namespace lumifield::virtual_bench {

namespace {

constexpr const char* library = "libumockdev-preload.so.0";

/// Puts a value before those that are there.
void put_before(const char* variable, const std::string& value) {
  const char* const others = std::getenv(variable);
  const bool any = others != nullptr && *others != '\0';
  setenv(variable, (value + (any ? std::string(":") + others : "")).c_str(), 1);
}

}  // namespace

Result<std::unique_ptr<UsbBus>> UsbBus::create() {
  void* const found = dlopen(library, RTLD_LAZY | RTLD_LOCAL);
  if (found == nullptr) return fail("is missing: there can be no virtual USB", library, "install umockdev");
  dlclose(found);
  if (!is_entered()) return fail("does not stand before this program: there can be no virtual USB", library, {});
  std::unique_ptr<UsbBus> bus(new UsbBus(umockdev_testbed_new()));
  const std::filesystem::path system = bus->root() / "sys/devices/system";
  std::error_code fault;
  std::filesystem::create_directories(system.parent_path(), fault);
  std::filesystem::create_directory_symlink("/sys/devices/system", system, fault);
  if (fault) return fail("cannot be linked: " + fault.message(), system.string(), "check TMPDIR");
  return bus;
}

UsbBus::~UsbBus() { g_object_unref(testbed_); }

void UsbBus::enter(char** argv) {
  constexpr const char* entering = "LUMIFIELD_ENTERS_USB_BUS";
  if (is_entered() || getenv(entering) != nullptr) return;
  setenv(entering, "1", 1);
  put_before("LD_PRELOAD", library);
#ifdef __SANITIZE_ADDRESS__
  put_before("ASAN_OPTIONS", "verify_asan_link_order=0");  // whose runtime is no longer the first library
#endif
  execv("/proc/self/exe", argv);
}

bool UsbBus::is_entered() {
  void* const found = dlopen(library, RTLD_LAZY | RTLD_NOLOAD);
  if (found != nullptr) dlclose(found);
  return found != nullptr;
}

std::filesystem::path UsbBus::root() const {
  char* const root = umockdev_testbed_get_root_dir(testbed_);
  std::filesystem::path path = root;
  g_free(root);
  return path;
}

}  // namespace lumifield::virtual_bench
