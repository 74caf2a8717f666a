// Three signed floats in 32 bits, on the host and in the passes.
#include "renderer/shift_invariant/srgbe.h"

#include <cstring>
#include <epoxy/gl.h>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "renderer/opengl/egl_context.h"
#include "renderer/opengl/gl_objects.h"
#include "renderer/renderer.h"
#include "renderer/shift_invariant/shift_invariant_device.h"
#include "renderer/shift_invariant/spot_shaders.h"
#include "renderer/study/synthetic_luminaire.h"

namespace lumifield {
namespace {

using Colour = std::array<float, 3>;

/// Signed, their magnitudes from 1e-30 to 1e30, of one colour within three decades.
std::vector<Colour> random_colours(std::size_t count) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> decade(-30, 30), below(-3, 0), unit(-1, 1);
  std::vector<Colour> colours(count);
  for (Colour& colour : colours) {
    const double most = std::pow(10.0, decade(random));
    for (float& c : colour) c = static_cast<float>(std::copysign(most * std::pow(10.0, below(random)), unit(random)));
    colour[random() % 3] = static_cast<float>(std::copysign(most, unit(random)));
  }
  return colours;
}

float most_of(const Colour& c) { return std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2])}); }

TEST(Srgbe, IsOffByNoMoreThan08PercentOfTheLargestChannel) {
  double worst = 0;
  for (const Colour& colour : random_colours(1'000'000)) {
    const auto bytes = to_srgbe(colour);
    ASSERT_TRUE(bytes);
    const Colour back = from_srgbe(*bytes);
    for (std::size_t c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(double(back[c]) - double(colour[c])) / double(most_of(colour)));
  }
  EXPECT_LE(worst, 0.008);
  EXPECT_GT(worst, 0.0075) << "half of 1/255 of four times the largest: 0.78 %";
}

TEST(Srgbe, ZeroIsExactAndASingleChannelCastsNoColour) {
  EXPECT_EQ(to_srgbe({0, 0, 0}).value(), (Srgbe{128, 128, 128, 0}));
  EXPECT_EQ(to_srgbe({-0.0F, 0, 0}).value(), (Srgbe{128, 128, 128, 0}));
  EXPECT_EQ(from_srgbe({128, 128, 128, 0}), (Colour{0, 0, 0}));
  for (const float c : {1.0F, -3e20F, 7e-33F}) {
    const Colour back = from_srgbe(to_srgbe({0, c, 0}).value());
    EXPECT_EQ(back[0], 0);
    EXPECT_EQ(back[2], 0);
    EXPECT_NEAR(back[1] / c, 1, 0.008);
  }
}

TEST(Srgbe, ReachesFromTheLeastNormalFloatToTheGreatest) {
  constexpr float least = std::numeric_limits<float>::min(), greatest = std::numeric_limits<float>::max();
  for (const float c : {least, greatest, -least, -greatest})
    EXPECT_NEAR(double(from_srgbe(to_srgbe({c, 0, 0}).value())[0]) / double(c), 1, 0.008) << c;
  for (const float flushed : {least / 2, -least / 4, std::numeric_limits<float>::denorm_min()})
    EXPECT_EQ(to_srgbe({flushed, 0, 0}).value(), (Srgbe{128, 128, 128, 0}));
}

TEST(Srgbe, RefusesWhatIsNotFinite) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf, -inf})
    for (std::size_t c = 0; c < 3; ++c) {
      Colour colour = {1, -2, 3};
      colour[c] = bad;
      EXPECT_FALSE(to_srgbe(colour));
    }
  for (const float c : from_srgbe(srgbe_not_finite)) EXPECT_TRUE(std::isnan(c));
}

/// Colours through a shader: coded by it, or decoded from bytes by it.
class SrgbeInShaders : public testing::Test {
 protected:
  static constexpr int width = 1000;
  void SetUp() override {
    auto made = EglContext::create();
    if (!made) GTEST_SKIP() << made.error().message();
    context_ = std::move(*made);
  }
  /// `out`: the pass' own format and what it holds.
  template <class In, class Out>
  std::vector<Out> through(const char* body, const std::vector<In>& in, unsigned in_format, unsigned in_type,
                           unsigned in_store, unsigned out_store, unsigned out_type) {
    const int height = static_cast<int>(in.size()) / width;
    const std::string vertex = std::string("#version 430 core\n") + spot_shaders::vertex;
    const std::string fragment = std::string("#version 430 core\n#define SRGBE 1\n") + spot_shaders::srgbe +
                                 "uniform sampler2D given; layout(location = 0) out vec4 made;\nvoid main() { vec4 t = "
                                 "texelFetch(given, ivec2(gl_FragCoord.xy), 0); " +
                                 body + " }\n";
    const auto program = compile_program("a test", {vertex.c_str(), nullptr, fragment.c_str()});
    EXPECT_TRUE(program) << program.error().message();
    const unsigned formats[] = {out_store};
    const auto target = RenderTarget::create("a test", width, height, formats, false);
    EXPECT_TRUE(target);
    GlTexture given;
    unsigned array = 0;
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, given.id());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<int>(in_store), width, height, 0, in_format, in_type, in.data());
    glViewport(0, 0, width, height);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glUseProgram(*program);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    std::vector<Out> out(in.size());
    glReadPixels(0, 0, width, height, GL_RGBA, out_type, out.data());
    EXPECT_TRUE(gl_status("a test"));
    glDeleteProgram(*program);
    glDeleteVertexArrays(1, &array);
    return out;
  }
  std::vector<Srgbe> coded(const std::vector<std::array<float, 4>>& colours) {
    return through<std::array<float, 4>, Srgbe>("made = srgbe(t.rgb);", colours, GL_RGBA, GL_FLOAT, GL_RGBA32F,
                                                GL_RGBA8, GL_UNSIGNED_BYTE);
  }
  std::unique_ptr<EglContext> context_;
};

TEST_F(SrgbeInShaders, CodeTheSameBytes) {
  std::vector<Colour> colours = random_colours(99'000);
  constexpr float least = std::numeric_limits<float>::min(), greatest = std::numeric_limits<float>::max(),
                  nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float c : {0.0F, -0.0F, least, -least, least / 2, greatest, -greatest, 1.0F, 0.5F, -0.5F, 0.99999994F})
    colours.insert(colours.end(), {{c, 0, 0}, {0, 0, c}, {c, c, -c}});
  for (const float bad : {nan, inf, -inf}) colours.insert(colours.end(), {{bad, 1, 1}, {0, 0, bad}});
  colours.resize(100'000, {0, 0, 0});
  std::vector<std::array<float, 4>> given;
  for (const Colour& c : colours) given.push_back({c[0], c[1], c[2], 0});
  const std::vector<Srgbe> bytes = coded(given);
  for (std::size_t k = 0; k < colours.size(); ++k)
    ASSERT_EQ(bytes[k], to_srgbe(colours[k]).value_or(srgbe_not_finite))
        << colours[k][0] << ", " << colours[k][1] << ", " << colours[k][2];
}

TEST_F(SrgbeInShaders, DecodeTheSameColours) {
  std::vector<Srgbe> bytes;
  for (const Colour& c : random_colours(98'000)) bytes.push_back(to_srgbe(c).value());
  for (int e = 0; e < 256; ++e) bytes.push_back({1, 128, 255, static_cast<std::uint8_t>(e)});
  bytes.push_back(srgbe_not_finite);
  bytes.resize(100'000, {128, 128, 128, 0});
  const auto colours = through<Srgbe, std::array<float, 4>>("made = vec4(from_srgbe(t), 1.0);", bytes, GL_RGBA,
                                                            GL_UNSIGNED_BYTE, GL_RGBA8, GL_RGBA32F, GL_FLOAT);
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    const Colour wanted = from_srgbe(bytes[k]);
    for (std::size_t c = 0; c < 3; ++c) {
      // What is below the normal floats may be 0.
      if (std::isnan(wanted[c])) {
        ASSERT_TRUE(std::isnan(colours[k][c]));
      } else {
        ASSERT_NEAR(colours[k][c], wanted[c], std::max(2e-7F * std::abs(wanted[c]), std::numeric_limits<float>::min()));
      }
    }
  }
}

/// Of sums that passes read, add to and write: RMS of the difference over that of float sums.
double off_in(const LightField& field, SpotSettings settings) {
  std::vector<CellIndex> cells;
  std::vector<std::shared_ptr<const CellImage>> images;
  for (int k = 0; k < field.geometry().sampling.cells(); ++k) {
    cells.push_back(field.geometry().sampling.index(k));
    images.push_back(field.cell(cells.back()));
  }
  std::vector<Receiver> at;
  for (int k = 0; k < 4000; ++k)
    at.push_back({{300.0 * (k % 80) / 80 - 150, 300.0 * (k / 80) / 50 - 150, 400 + 3.0 * (k % 7)},
                  Vec3(0.2 * std::sin(k), 0.2 * std::cos(k), -1).normalized()});
  std::vector<double> sums[2];
  for (const SpotSums kind : {SpotSums::float32, SpotSums::srgbe}) {
    settings.sums = kind;
    const auto device = ShiftInvariantDevice::create(field.geometry(), settings).value();
    EXPECT_TRUE(device->set_receivers(at));
    EXPECT_TRUE(device->add_cells(cells, images));
    EXPECT_TRUE(device->read(sums[static_cast<std::size_t>(kind)]));
  }
  double squares = 0, all = 0;
  for (std::size_t k = 0; k < sums[0].size(); ++k) {
    squares += std::pow(sums[1][k] - sums[0][k], 2);
    all += std::pow(sums[0][k], 2);
  }
  return std::sqrt(squares / all);
}

TEST(SrgbeSums, OfSixtyThreeCellsAreWithinOneAndAHalfPercent) {
  if (const auto found = probe_opengl(); !found) GTEST_SKIP() << found.error().message();
  for (const int channels : {1, 3}) {
    const LightField field = make_luminaire({.name = "bike", .pixels = 75, .pixel_mm = 4}, channels);
    for (const int x : {16, 3, 1}) {
      const double off = off_in(field, {.look_up = SpotLookUp::textured, .cells_per_pass = x});
      std::printf("%d channels, X = %d: relative RMSE %.3g %%\n", channels, x, 100 * off);
      // Errors of passes add up as chance: 63 of them are more than the 21 that the format was made for.
      EXPECT_LE(off, x == 1 ? 0.03 : 0.015);
      EXPECT_GT(off, 1e-4) << "they are other sums";
    }
  }
}

}  // namespace
}  // namespace lumifield
