#pragma once

#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/renderer.h"
#include "renderer/study/study_bench.h"
#include "renderer/study/synthetic_luminaire.h"

namespace lumifield {

namespace fs = std::filesystem;

/// As where there is no place for temporary files.
class WithoutTemporaryFolder {
 public:
  WithoutTemporaryFolder() {
    if (const char* before = std::getenv("TMPDIR")) before_ = before;
    setenv("TMPDIR", "/proc/no-such-folder", 1);
  }
  ~WithoutTemporaryFolder() { before_ ? setenv("TMPDIR", before_->c_str(), 1) : unsetenv("TMPDIR"); }
  WithoutTemporaryFolder(const WithoutTemporaryFolder&) = delete;
  WithoutTemporaryFolder& operator=(const WithoutTemporaryFolder&) = delete;

 private:
  std::optional<std::string> before_;
};

/// A folder for references, removed with all in it.
class CacheFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "lumifield-cache-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::vector<fs::path> files() const {
    std::vector<fs::path> all;
    for (const auto& entry : fs::directory_iterator(folder_)) all.push_back(entry.path());
    return all;
  }
  fs::path folder_;
};

/// A luminaire of 3×2 cells before one of the demo scenes.
class StudyOfASmallLuminaire : public CacheFolder {
 protected:
  void SetUp() override {
    CacheFolder::SetUp();
    if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
    if (const auto found = probe_opengl(); !found) GTEST_SKIP() << found.error().message();
    camera_ = camera_of("corner");
    luminaire_.emplace(StudyLuminaire{
        "small", make_luminaire({.name = "small", .columns = 3, .rows = 2, .pixels = 75, .pixel_mm = 4})});
  }
  static std::unique_ptr<StudyCamera> camera_of(const std::string& scene) {
    return read_scene(std::string(LUMIFIELD_SOURCE_DIR) + "/resources/scenes/" + scene + "/scene.json")
        .and_then(StudyCamera::create)
        .value();
  }

  std::unique_ptr<StudyCamera> camera_;
  std::optional<StudyLuminaire> luminaire_;
};

}  // namespace lumifield
