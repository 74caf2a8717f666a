#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>
#include <vector>

#include "renderer/methods/closed_form_shared.h"
#include "renderer/opencl/device.h"
#include "renderer/opencl/kernel_source.h"
#include "renderer/renderer.h"
#include "tests/support/kernel_layout.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

/// Sets an environment variable for one test.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
  ~Environment() { unsetenv(name_); }

 private:
  const char* name_;
};

TEST(OpenClDevice, StructsAreLaidOutAsOnTheHost) {
  if (const auto device = OpenClDevice::create(); !device) GTEST_SKIP() << device.error().message();
  const std::vector<int> layout = test::layout_by("closed_form", "closed_form_layout", 16);
  EXPECT_EQ(layout, (std::vector<int>{
                        sizeof(ClosedFormGeometry), offsetof(ClosedFormGeometry, corner_x),
                        offsetof(ClosedFormGeometry, levels), offsetof(ClosedFormGeometry, cells),
                        sizeof(ClosedFormReceiver), offsetof(ClosedFormReceiver, n_z), sizeof(ClosedFormCell),
                        offsetof(ClosedFormCell, sign), offsetof(ClosedFormCell, image), sizeof(ClosedFormLevel),
                        offsetof(ClosedFormLevel, offset), offsetof(ClosedFormCell, column), sizeof(ClosedFormGrid),
                        offsetof(ClosedFormGrid, rows), sizeof(ClosedFormTiles), offsetof(ClosedFormTiles, first)}));
}

TEST(OpenClDevice, AnArgumentThatCannotBeSetIsAnErrorUntilItIs) {
  auto device = OpenClDevice::create();
  if (!device) GTEST_SKIP() << device.error().message();
  auto kernel = (*device)->build("probe", "", "probe");
  ASSERT_TRUE(kernel) << kernel.error().message();
  const auto buffer = (*device)->allocate(sizeof(double), "a number");
  ASSERT_TRUE(buffer);
  kernel->set(0, *buffer);
  kernel->set(1, 'x');
  for (int k = 0; k < 2; ++k) {
    const auto refused = (*device)->run(*kernel, 1, 1);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message(), HasSubstr("setting argument 1 of probe"));
  }
  kernel->set(0, *buffer);
  EXPECT_FALSE((*device)->run(*kernel, 1, 1)) << "another argument does not stand for it";
  kernel->set(1, 20.5);
  EXPECT_TRUE((*device)->run(*kernel, 1, 1));
}

TEST(OpenClDevice, ProbeNamesTheDevice) {
  const auto probed = probe_opencl();
  auto device = OpenClDevice::create();
  ASSERT_EQ(probed.has_value(), device.has_value());
  if (!probed) GTEST_SKIP() << probed.error().message();
  EXPECT_THAT(*probed, HasSubstr((*device)->name()));
  EXPECT_THAT(*probed, HasSubstr("OpenCL"));
}

TEST(OpenClDevice, RefusesADeviceThatIsNotThere) {
  if (!probe_opencl()) GTEST_SKIP() << probe_opencl().error().message();
  const Environment wanted("LUMIFIELD_OPENCL", "no such device");
  const auto device = OpenClDevice::create();
  ASSERT_FALSE(device);
  EXPECT_THAT(device.error().message(), HasSubstr("no such device"));
}

TEST(OpenClDevice, ADriverThatEndsTheProgramBecomesAnError) {
  // A fresh process, since this one may know its driver already: the loader is given a driver that ends it when opened.
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("ending-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const std::string library = (folder / "driver.so").string();
  std::ofstream(folder / "driver.icd") << library << "\n";
  const auto in_fresh_process = [&] {
    setenv("OCL_ICD_VENDORS", folder.c_str(), 1);
    const auto probed = probe_opencl();
    std::fprintf(stderr, "%s\n", probed ? "usable" : probed.error().message().c_str());
    std::exit(probed ? 0 : 3);
  };
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const auto& [call, how] : {std::pair{"abort()", "ended with signal 6"}, {"_Exit(7)", "exit status 7"}}) {
    std::ofstream(folder / "driver.c") << "#include <stdlib.h>\n__attribute__((constructor)) void start(void) { "
                                       << call << "; }\n";
    ASSERT_EQ(std::system(("cc -shared -fPIC -o " + library + " " + (folder / "driver.c").string()).c_str()), 0);
    EXPECT_EXIT(in_fresh_process(), testing::ExitedWithCode(3), how);
  }
  std::filesystem::remove_all(folder);
}

TEST(OpenClDevice, AFolderWithoutDriversIsAnError) {
  const auto in_fresh_process = [] {
    setenv("OCL_ICD_VENDORS", "/nonexistent/", 1);
    const auto device = OpenClDevice::create();
    std::fprintf(stderr, "%s\n", device ? "usable" : device.error().message().c_str());
    std::exit(device ? 0 : 3);
  };
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(in_fresh_process(), testing::ExitedWithCode(3), "no OpenCL platform");
}

TEST(OpenClDevice, RefusesABufferLargerThanTheDeviceTakes) {
  auto device = OpenClDevice::create();
  if (!device) GTEST_SKIP() << device.error().message();
  const auto buffer = (*device)->allocate((*device)->max_buffer_bytes() + 1, "everything");
  ASSERT_FALSE(buffer);
  EXPECT_THAT(buffer.error().message(), HasSubstr("everything"));
}

TEST(OpenClDevice, ABrokenKernelGivesTheCompilersLog) {
  auto device = OpenClDevice::create();
  if (!device) GTEST_SKIP() << device.error().message();
  const std::filesystem::path root = std::filesystem::temp_directory_path() / ("kernels-" + std::to_string(getpid()));
  std::filesystem::create_directories(root / "renderer/opencl");
  std::ofstream(root / "renderer/opencl/probe.cl") << "__kernel void probe(__global int* x) { x[0] = unheard_of; }\n";
  const Environment kernels("LUMIFIELD_KERNELS", root.string());
  const auto kernel = (*device)->build("probe", "", "probe");
  std::filesystem::remove_all(root);
  ASSERT_FALSE(kernel);
  EXPECT_THAT(kernel.error().message(), HasSubstr("unheard_of"));
}

TEST(KernelSource, EmbeddedTextHasItsIncludesResolved) {
  const auto source = kernel_source("closed_form");
  ASSERT_TRUE(source);
  EXPECT_THAT(source->text, HasSubstr("struct ClosedFormGeometry"));
  EXPECT_THAT(source->text, testing::Not(HasSubstr("#include \"")));
  EXPECT_FALSE(kernel_source("no such kernel"));
}

}  // namespace
}  // namespace lumifield
