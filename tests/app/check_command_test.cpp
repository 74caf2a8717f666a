#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/cli/command_line.h"
#include "renderer/picture.h"
#include "tests/support/dataset_folder.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

class CheckCommand : public support::TemporaryFolder {
 protected:
  /// Of a scene that names this environment; what is found goes to `out`.
  int check_with(const std::string& environment) {
    const std::string scene = folder_ / "scene.json";
    support::write_text(scene, R"({"format": "lumifield-scene", "version": 1, "mesh": "room.obj", "environment": ")" +
                                   environment +
                                   R"(", "camera": {"position_mm": [0, 0, 1], "target_mm": [1, 0, 1], "up": [0, 0, 1],
                                       "fov_y_deg": 45}, "luminaires": []})");
    std::vector<std::string> arguments{"lumifield", "check", scene};
    std::vector<char*> argv;
    for (std::string& each : arguments) argv.push_back(each.data());
    argv.push_back(nullptr);
    testing::internal::CaptureStdout();
    const int code = run_command_line(
        static_cast<int>(arguments.size()), argv.data(), [](int, char**, const WindowOptions&) { return 99; },
        [](const Study&, const std::filesystem::path&) { return Status{}; });
    out = testing::internal::GetCapturedStdout();
    return code;
  }
  std::string image(const std::string& name, int width, int height) const {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    EXPECT_TRUE(write_exr({width, height, std::vector<float>(3 * pixels, 1), std::vector<float>(pixels, 1), {}},
                          folder_ / name));
    return name;
  }

  std::string out;
};

TEST_F(CheckCommand, ReadsTheEnvironmentOfAScene) {
  EXPECT_EQ(check_with("none.exr"), 1);
  EXPECT_THAT(out, HasSubstr("NOT sound"));
  EXPECT_THAT(out, HasSubstr("none.exr"));
  EXPECT_EQ(check_with(image("sky.exr", 3, 2)), 1);
  EXPECT_THAT(out, HasSubstr("sky.exr: is an image of 3 x 2 pixels, no latitude-longitude map"));
  EXPECT_EQ(check_with(image("sky.exr", 4, 2)), 0) << out;
  EXPECT_THAT(out, HasSubstr("scene.json: sound"));
}

}  // namespace
}  // namespace lumifield
