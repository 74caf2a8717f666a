#pragma once

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <unistd.h>

#include "luminaire/light_field.h"

namespace lumifield::support {

/// A folder of its own for each test, removed afterwards; in memory where that is possible, since these tests flush
/// often.
class TemporaryFolder : public testing::Test {
 protected:
  ~TemporaryFolder() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ = [] {
    const bool in_memory = ::access("/dev/shm", W_OK) == 0;
    const std::filesystem::path parent = in_memory ? "/dev/shm" : testing::TempDir();
    std::string name = (parent / "lumifield.XXXXXX").string();
    return std::filesystem::path(::mkdtemp(name.data()));
  }();
};

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

/// Names and bytes of all files below a folder.
inline std::string contents_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& each : std::filesystem::recursive_directory_iterator(folder))
    files[each.path().lexically_relative(folder).string()] = each.is_regular_file() ? read_text(each.path()) : "";
  std::ostringstream all;
  for (const auto& [name, text] : files) all << name << '\n' << text.size() << '\n' << text << '\n';
  return all.str();
}

inline LuminaireGeometry geometry(int columns, int rows, int width_px, int height_px,
                                  std::vector<std::string> channels) {
  LuminaireGeometry g;
  g.planes.separation_mm = 150;
  g.sampling = {BasisKind::bell, {7.5, 7.5}, columns, rows, {0, 0}};
  g.measurement = {width_px, height_px, {1, 1}, {0, 0}};
  g.channels = std::move(channels);
  return g;
}

/// Random values, negative ones among them, with variance; drift not determined.
inline CellImage cell_image(const LuminaireGeometry& g, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(1, 2);
  CellImage image;
  image.width_px = g.measurement.width_px;
  image.height_px = g.measurement.height_px;
  image.channels = static_cast<int>(g.channels.size());
  image.value.resize(g.measurement.pixels() * g.channels.size());
  image.variance.resize(image.value.size());
  for (float& v : image.value) v = normal(random);
  for (float& v : image.variance) v = std::abs(normal(random));
  image.quality = {0.25, 0, 17.5, 0.003, std::numeric_limits<double>::quiet_NaN(), 64.5, {"median SNR 17.5 < 20"}, {}};
  image.quality.exposures_s["positive"] = {0.0005, 0.002};
  return image;
}

}  // namespace lumifield::support
