// An environment: its maps, its harmonics, and what surfaces reflect of it, against plain sums over its image.
#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <unistd.h>

#include "renderer/environment/environment_light.h"
#include "renderer/methods/gloss.h"
#include "renderer/methods/lobe_sampling.h"
#include "tests/support/exr_file.h"

namespace lumifield {
namespace {

constexpr double pi = std::numbers::pi;

template <class Colour>
LatLong painted(int height, const Colour& colour) {
  const int width = 2 * height;
  std::vector<float> rgb(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const LatLong empty(width, height, rgb);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const std::array<double, 3> light = colour(empty.direction(i + 0.5, j + 0.5));
      for (std::size_t c = 0; c < 3; ++c)
        rgb[3 * (static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)) + c] =
            static_cast<float>(light[c]);
    }
  return {width, height, std::move(rgb)};
}

/// A sky that fades to the horizon, a dark ground, and some lamps, the larger `sharp` the smaller.
LatLong made_up(int height = 64, double sharp = 200) {
  const Vec3 lamps[] = {Vec3(1, 0.2, 0.5).normalized(), Vec3(-0.4, 1, 0.1).normalized(),
                        Vec3(0.1, -0.3, 1).normalized(), Vec3(0.5, -1, -0.2).normalized()};
  return painted(height, [&](const Vec3& d) {
    const double sky = d.z() > 0 ? 0.5 + d.z() : 0.2;
    std::array<double, 3> colour{0.6 * sky, 0.8 * sky, sky};
    for (std::size_t k = 0; k < 4; ++k) {
      const double light = 0.1 * sharp * std::exp(sharp * (d.dot(lamps[k]) - 1));
      for (std::size_t c = 0; c < 3; ++c) colour[c] += light * (c == k % 3 ? 1 : 0.5);
    }
    return colour;
  });
}

std::vector<Vec3> directions(int count) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vec3> all{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
  while (static_cast<int>(all.size()) < count)
    all.push_back(Vec3(normal(random), normal(random), normal(random)).normalized());
  return all;
}

/// ∫ g(L, ω) dω over the image's pixels.
template <class G>
double over_pixels(const LatLong& image, const G& g) {
  double sum = 0;
  for (int j = 0; j < image.height_px(); ++j)
    for (int i = 0; i < image.width_px(); ++i)
      sum += image.solid_angle(j) * g(image.pixel(i, j), image.direction(i + 0.5, j + 0.5));
  return sum;
}

TEST(LatLong, LooksWhereItsDocumentationSays) {
  const LatLong image = made_up(8);
  EXPECT_NEAR((image.direction(8, 4) - Vec3(0, 1, 0)).norm(), 0, 1e-12) << "the middle is +y";
  EXPECT_NEAR((image.direction(12, 4) - Vec3(1, 0, 0)).norm(), 0, 1e-12) << "+x is to the right";
  EXPECT_NEAR((image.direction(3, 0) - Vec3(0, 0, 1)).norm(), 0, 1e-12);
  double all = 0;
  for (int j = 0; j < 8; ++j) all += 16 * image.solid_angle(j);
  EXPECT_NEAR(all, 4 * pi, 1e-12);
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 16; ++i) EXPECT_EQ(image.radiance(3 * image.direction(i + 0.3, j + 0.7)), image.pixel(i, j));
}

TEST(LatLong, IsReadFromAFileOfItsShape) {
  const auto file = std::filesystem::temp_directory_path() / ("sky-" + std::to_string(getpid()) + ".exr");
  for (const int width : {4, 6}) {
    support::ExrFile exr(width, 2);
    for (const char* name : {"R", "G", "B"}) {
      exr.channels[name] = Imf::HALF;
      exr.pixels[name].assign(static_cast<std::size_t>(2 * width), name[0] == 'G' ? 2.0F : 0.5F);
    }
    exr.write(file);
    const auto read = LatLong::read(file);
    ASSERT_EQ(read.has_value(), width == 4);
    if (read)
      EXPECT_EQ(read->pixel(3, 1), (std::array<double, 3>{0.5, 2, 0.5}));
    else
      EXPECT_NE(read.error().message().find("twice as wide as high"), std::string::npos);
  }
  std::filesystem::remove(file);
  EXPECT_FALSE(LatLong::read(file));
}

TEST(LatLong, OfACroppedFileLooksWhereItsDisplayWindowSays) {
  const auto file = std::filesystem::temp_directory_path() / ("sky-" + std::to_string(getpid()) + ".exr");
  support::ExrFile exr(1, 1);
  exr.display_window = {{0, 0}, {15, 7}};
  exr.data_window = {{12, 1}, {13, 1}};  // itself twice as wide as high
  exr.channels["Y"] = Imf::FLOAT;
  exr.pixels["Y"] = {3, 5};
  exr.write(file);
  const auto read = LatLong::read(file);
  std::filesystem::remove(file);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->width_px(), 16);
  EXPECT_EQ(read->radiance(read->direction(12.5, 1.5))[0], 3);
  EXPECT_EQ(read->radiance(read->direction(13.5, 1.5))[0], 5);
  EXPECT_EQ(read->radiance(Vec3(0, 1, 0))[0], 0);
  EXPECT_EQ(read->note(), "it is black where its data window ends before its display window");
}

TEST(DualParaboloid, TexelsSpanWhatTheMappingSays) {
  // The four corners of a texel span Ω_p, and its own half adds up to a half space.
  const DualParaboloid map(made_up());
  EXPECT_GE(map.side_px(), 64);
  const double side = map.side_px(), b = DualParaboloid::b;
  double all = 0;
  for (int row = 0; row < map.side_px(); ++row)
    for (int column = 0; column < map.side_px(); ++column) {
      const double x = 2 * b * ((column + 0.5) / side - 0.5), y = 2 * b * ((row + 0.5) / side - 0.5);
      const double z = (1 - x * x - y * y) / (1 + x * x + y * y);
      if (z >= 0) all += map.texel_solid_angle(z);
    }
  EXPECT_NEAR(all, 2 * pi, 0.01 * 2 * pi);
  EXPECT_DOUBLE_EQ(map.level(4 * map.texel_solid_angle(0.3), 0.3), 1 + DualParaboloid::overlap);
  EXPECT_DOUBLE_EQ(map.level(1e-9, 0.3), DualParaboloid::overlap);
}

/// Random light without any symmetry.
LatLong speckled(int height) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform;
  return painted(height, [&](const Vec3&) { return std::array{uniform(random), uniform(random), uniform(random)}; });
}

TEST(DualParaboloid, TexelsAreTheMeansOfWhatTheySee) {
  const LatLong image = speckled(64);
  const DualParaboloid map(image);
  constexpr double b = DualParaboloid::b;
  ASSERT_EQ(map.side_px(), 128);
  const auto direction = [](double s, double t, int half) {
    const double x = 2 * b * (s - 0.5), y = 2 * b * (t - 0.5), r2 = x * x + y * y;
    return Vec3(Vec3(2 * x, 2 * y, half == 0 ? 1 - r2 : r2 - 1) / (1 + r2));
  };
  int seen = 0;
  for (int k = 0; k < 2 * 128 * 128; ++k) {
    const int column = k % 128, row = k / 128 % 128, half = k / (128 * 128);
    const Vec3 middle = direction((column + 0.5) / 128, (row + 0.5) / 128, half);
    if (half == 0 ? middle.z() < 0 : middle.z() >= 0) continue;  // looked up in the other half
    if (column == row || column + row == 127) continue;          // on the edge of two pixels, either of which will do
    double sum = 0, all = 0;
    for (int point = 0; point < 9; ++point) {
      const Vec3 d = direction((column + (point % 3 + 0.5) / 3) / 128, (row + (point / 3 + 0.5) / 3) / 128, half);
      const double z = half == 0 ? d.z() : -d.z(), part = (1 + z) * (1 + z);
      sum += part * image.radiance(d)[1];
      all += part;
    }
    EXPECT_NEAR(map.radiance(middle, 0)[1], sum / all, 2e-5) << column << ' ' << row << ' ' << half;
    ++seen;
  }
  EXPECT_GT(seen, 2 * 128 * 128 / 2);
}

TEST(DualParaboloid, IsNotMadeOnceToldToStop) {
  const LatLong image = made_up(16);
  std::stop_source end;
  EXPECT_TRUE(DualParaboloid::make(image, end.get_token()));
  end.request_stop();
  EXPECT_FALSE(DualParaboloid::make(image, end.get_token()));
}

TEST(DualParaboloid, ShowsTheEnvironmentAtEveryLevelAndAcrossTheSeam) {
  const auto wanted = [](const Vec3& d) {
    return std::array{2 + d.x() + 0.5 * d.y() - 0.3 * d.z(), 2 - d.y(), 1.5 + 0.7 * d.z()};
  };
  const LatLong image = painted(128, wanted);
  const DualParaboloid map(image);
  for (const Vec3& d : directions(300))
    for (const double level : {0.0, 1.0, 2.5, 4.0}) {
      const Eigen::Array4f got = map.radiance(d, level);
      // Half a texel, which spans 4 b/side at most.
      const double off = 0.5 * 4 * DualParaboloid::b / map.side_px() * std::exp2(level) + 2 * pi / image.width_px();
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted(d)[std::size_t(c)], off) << d.transpose() << ' ' << level;
    }
  for (double turn = 0; turn < 6.28; turn += 0.1)
    for (const double level : {0.0, 2.0, 4.5}) {
      const Vec3 across(std::cos(turn), std::sin(turn), 0);
      const float above = map.radiance((across + Vec3(0, 0, 1e-6)).normalized(), level)[0];
      const float below = map.radiance((across - Vec3(0, 0, 1e-6)).normalized(), level)[0];
      EXPECT_NEAR(above, below, 0.03) << turn << ' ' << level;
    }
}

TEST(DualParaboloid, LevelsKeepTheLight) {
  // Bright pixels, one at the seam, where the halves are averaged apart: over all directions their light stays.
  std::vector<float> rgb(3 * 128 * 64, 0.0F);
  for (const auto& [i, j] : {std::pair(20, 12), {90, 31}, {64, 60}})
    rgb[static_cast<std::size_t>(3 * (j * 128 + i))] = 1;
  const LatLong image(128, 64, rgb);
  const DualParaboloid map(image);
  const double exact = image.solid_angle(12) + image.solid_angle(31) + image.solid_angle(60);
  const LatLong sphere(1024, 512, std::vector<float>(3 * 1024 * 512));
  for (const double level : {0.0, 1.0, 2.0, 3.0, 4.0}) {
    const double all =
        over_pixels(sphere, [&](const auto&, const Vec3& d) { return static_cast<double>(map.radiance(d, level)[0]); });
    EXPECT_NEAR(all, exact, 0.12 * exact) << level;
  }
}

TEST(IrradianceHarmonics, AreOrthonormalAndOfAFirstDegreeExact) {
  const LatLong even(128, 64, std::vector<float>(3 * 128 * 64, 1.0F));
  for (std::size_t a = 0; a < 9; ++a)
    for (std::size_t b = a; b < 9; ++b)
      EXPECT_NEAR(over_pixels(even,
                              [&](const auto&, const Vec3& d) {
                                const auto y = IrradianceHarmonics::basis(d);
                                return y[a] * y[b];
                              }),
                  a == b ? 1 : 0, 2e-3);
  for (const Vec3& n : directions(20)) EXPECT_NEAR(IrradianceHarmonics(even).irradiance(n)[1], pi, 1e-3);
}

/// Each pixel repeated, `times` an axis: the same light.
LatLong repeated(const LatLong& image, int times) {
  const LatLong empty(image.width_px() * times, image.height_px() * times, {});
  std::vector<float> rgb;
  for (int j = 0; j < empty.height_px(); ++j)
    for (int i = 0; i < empty.width_px(); ++i)
      for (const double each : image.pixel(i / times, j / times)) rgb.push_back(static_cast<float>(each));
  return {empty.width_px(), empty.height_px(), std::move(rgb)};
}

TEST(IrradianceHarmonics, OfFewPixelsAreThoseOfTheSameLightOnMany) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform;
  for (const int height : {1, 2, 4}) {
    std::vector<float> rgb(6 * static_cast<std::size_t>(height * height), 1.0F);
    for (const Vec3& n : directions(20))
      EXPECT_NEAR(IrradianceHarmonics(LatLong(2 * height, height, rgb)).irradiance(n)[1], pi, 1e-12) << height;
    for (float& each : rgb) each = uniform(random);
    const LatLong few(2 * height, height, rgb), many = repeated(few, 128 / height);
    const IrradianceHarmonics harmonics(few);
    for (const Vec3& n : directions(20)) {
      EXPECT_NEAR(harmonics.irradiance(n)[1], IrradianceHarmonics(many).irradiance(n)[1], 1e-12) << height;
      // By the definition, Y at the middle of each of many pixels.
      double wanted = 0;
      for (std::size_t k = 0; k < 9; ++k)
        wanted += (k == 0  ? pi
                   : k < 4 ? 2 * pi / 3
                           : pi / 4) *
                  IrradianceHarmonics::basis(n)[k] * over_pixels(many, [&](const auto& light, const Vec3& d) {
                    return light[1] * IrradianceHarmonics::basis(d)[k];
                  });
      EXPECT_NEAR(harmonics.irradiance(n)[1], wanted, 3e-4 * pi) << height;
    }
  }
}

TEST(IrradianceHarmonics, OfASmallSourceAreOffAsStated) {
  std::vector<float> rgb(3 * 256 * 128, 0.0F);
  rgb[3 * (70 * 256 + 30) + 1] = 1;
  const LatLong image(256, 128, rgb);
  const IrradianceHarmonics harmonics(image);
  const Vec3 source = image.direction(30.5, 70.5);
  Vec3 across, along;
  frame_about(source, across, along);
  double least = 1, most = -1, lowest = 1;
  for (int degrees = 0; degrees <= 180; ++degrees) {
    const double cosine = std::cos(degrees * pi / 180), sine = std::sin(degrees * pi / 180);
    const double e = harmonics.irradiance(cosine * source + sine * across)[1] / image.solid_angle(70);
    EXPECT_NEAR(e, 0.25 + cosine / 2 + 5.0 / 32 * (3 * cosine * cosine - 1), 1e-3) << degrees;
    least = std::min(least, e - std::max(0.0, cosine));
    most = std::max(most, e - std::max(0.0, cosine));
    lowest = std::min(lowest, e);
  }
  EXPECT_NEAR(least, -0.04, 0.001);
  EXPECT_NEAR(most, 0.094, 0.001);
  EXPECT_NEAR(lowest, -0.04, 0.001);
}

TEST(IrradianceHarmonics, AreNearTheIrradiance) {
  const LatLong image = made_up();
  const IrradianceHarmonics harmonics(image);
  const auto points = environment_reference_points(100'000);
  double squares = 0, sum = 0;
  for (const Vec3& n : directions(60)) {
    const double exact =
        over_pixels(image, [&](const auto& light, const Vec3& d) { return light[1] * std::max(n.dot(d), 0.0); });
    const double off = harmonics.irradiance(n)[1] - exact;
    EXPECT_LT(std::abs(off), 0.15 * exact);
    squares += off * off / 60, sum += exact / 60;
    // The reference is plain samples of the same.
    EXPECT_NEAR(environment_reference(image, {}, n, points)[1], exact, 3e-3 * exact);
  }
  EXPECT_LT(std::sqrt(squares), 0.05 * sum) << "degrees of 4 and more";
}

GlossLobe lobe_of(int kind, float shape, const Vec3& eye) {
  const Eigen::Vector3f o = eye.cast<float>();
  return {o.x(), o.y(), o.z(), shape, 0.5F, 0.6F, 0.7F, kind};
}

TEST(EnvironmentLight, ShinesAsTheReferenceDoes) {
  const LatLong image = made_up(128);
  const EnvironmentLight plain(image, 2, {20'000, false}), filtered(image, 2, {20'000, true});
  const auto points = environment_reference_points(100'000);
  const auto all = directions(24);
  for (const auto& [kind, shape] : {std::pair(LOBE_PHONG, 50.0F), {LOBE_GGX, 0.09F}})
    for (std::size_t k = 4; k + 1 < all.size(); ++k) {
      const Vec3 n = all[k].dot(all[k + 1]) > 0 ? all[k] : Vec3(-all[k]);
      if (n.dot(all[k + 1]) < 0.4) continue;  // a lobe at grazing angles is narrower than a pixel
      const GlossLobe lobe = lobe_of(kind, shape, all[k + 1]);
      const auto wanted = environment_reference(image, lobe, n, points);
      const double exact = over_pixels(image, [&](const auto& light, const Vec3& d) {
        return light[1] * glossy_brdf(lobe, n, d)[1] * std::max(n.dot(d), 0.0);
      });
      EXPECT_NEAR(wanted[1], exact, 0.01 * exact);
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(plain.gloss(lobe, n)[c], 2 * wanted[c], 0.01 * 2 * wanted[c]);
        EXPECT_NEAR(filtered.gloss(lobe, n)[c], 2 * wanted[c], 0.02 * 2 * wanted[c]);
      }
    }
}

TEST(EnvironmentLight, FewFilteredSamplesAreNearerThanPlainOnes) {
  const LatLong image = made_up(128, 4000);
  const auto points = environment_reference_points(20'000);
  const auto all = directions(200);
  for (const auto& [kind, shape] : {std::pair(LOBE_PHONG, 50.0F), {LOBE_GGX, 0.09F}})
    for (const int samples : {10, 40, 200}) {
      const EnvironmentLight plain(image, 1, {samples, false}), filtered(image, 1, {samples, true});
      double with = 0, without = 0;
      for (std::size_t k = 4; k + 1 < all.size(); ++k) {
        const Vec3 n = all[k].dot(all[k + 1]) > 0 ? all[k] : Vec3(-all[k]);
        const GlossLobe lobe = lobe_of(kind, shape, all[k + 1]);
        const double wanted = environment_reference(image, lobe, n, points)[1];
        with += std::pow(filtered.gloss(lobe, n)[1] - wanted, 2);
        without += std::pow(plain.gloss(lobe, n)[1] - wanted, 2);
      }
      EXPECT_LT(with, 0.5 * without) << kind << ' ' << samples;
    }
}

TEST(EnvironmentLight, ByOtherSamplesIsAsIfMadeOfThem) {
  const LatLong image = made_up(32);
  const Vec3 n(0, 0, 1);
  const GlossLobe lobe = lobe_of(LOBE_PHONG, 20, Vec3(0.6, 0, 0.8));
  for (const bool filter : {true, false}) {
    const EnvironmentLight few(image, 2, {10, filter, 1}), many(image, 2, {300, filter, 4});
    EXPECT_NE(few.gloss(lobe, n), many.gloss(lobe, n));
    EXPECT_EQ(few.with(300, 4).gloss(lobe, n), many.gloss(lobe, n));
  }
}

TEST(EnvironmentLight, IsReadWithItsMapUnlessToldToStop) {
  const auto file = std::filesystem::temp_directory_path() / ("sky-" + std::to_string(getpid()) + ".exr");
  support::ExrFile exr(8, 4);
  exr.channels["Y"] = Imf::FLOAT;
  exr.pixels["Y"].assign(32, 2.0F);
  exr.write(file);
  std::stop_source end;
  const auto light = EnvironmentLight::read(file, 1, {}, end.get_token());
  ASSERT_TRUE(light) << light.error().message();
  const Vec3 n(0, 0, 1);
  EXPECT_NEAR((*light)->gloss(lobe_of(LOBE_PHONG, 20, n), n)[0], 2 * 0.5, 1e-2);
  end.request_stop();
  const auto stopped = EnvironmentLight::read(file, 1, {}, end.get_token());
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
  EXPECT_TRUE(EnvironmentLight::read(file, 1, {.filter = false}, end.get_token())) << "there is no map to be made";
  std::filesystem::remove(file);
}

TEST(EnvironmentLight, SaysWhatItDoesNotShowOfItsFile) {
  const auto file = std::filesystem::temp_directory_path() / ("sky-" + std::to_string(getpid()) + ".exr");
  const auto notes = [&](int width, bool alpha, bool filter) {
    support::ExrFile exr(width, width / 2);
    for (const char* name : {"Y", "A"}) {
      if (name[0] == 'A' && !alpha) continue;
      exr.channels[name] = Imf::HALF;
      exr.pixels[name].assign(static_cast<std::size_t>(width * width / 2), 1.0F);
    }
    exr.write(file);
    const auto light = EnvironmentLight::read(file, 1, {.filter = filter});
    return light ? (*light)->notes() : std::vector{light.error().message()};
  };
  EXPECT_THAT(notes(8, false, true), testing::IsEmpty());
  EXPECT_THAT(notes(8, true, true), testing::ElementsAre(file.string() + ": its alpha is not shown"));
  EXPECT_THAT(notes(2680, false, true), testing::IsEmpty());
  EXPECT_THAT(
      notes(3000, false, true),
      testing::ElementsAre(file.string() + ": its pixels span 0.12°, but gloss reflects it in texels of up to 0.13°"));
  EXPECT_THAT(notes(3000, false, false), testing::IsEmpty()) << "it reflects the pixels";
  std::filesystem::remove(file);
}

TEST(EnvironmentLight, OfAnEyeBelowTheSurfaceOrADullOneDoesNotShine) {
  const EnvironmentLight light(made_up(16), 1);
  const Vec3 n(0, 0, 1);
  EXPECT_EQ(light.gloss(lobe_of(LOBE_GGX, 0.1F, Vec3(0, 0.6, -0.8)), n)[0], 0);
  EXPECT_EQ(light.gloss(lobe_of(LOBE_NONE, 0.1F, n), n)[0], 0);
  EXPECT_GT(light.gloss(lobe_of(LOBE_GGX, 0.1F, n), n)[0], 0);
}

}  // namespace
}  // namespace lumifield
