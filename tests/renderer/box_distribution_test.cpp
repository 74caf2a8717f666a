#include "renderer/sampling/box_distribution.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/support/chi_square.h"

namespace lumifield {
namespace {

SummedAreaTable random_image(int width, int height, unsigned seed, double bright = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-0.3, 1);
  std::vector<double> image;
  for (int k = 0; k < width * height; ++k) image.push_back(std::max(unit(random), 0.0));
  image[image.size() / 3] *= bright;
  return {image, width, height};
}

/// The integral pixel by pixel.
double summed(const SummedAreaTable& image, const PixelBox& box) {
  double sum = 0;
  for (int j = 0; j < image.height_px(); ++j)
    for (int i = 0; i < image.width_px(); ++i) {
      const double w = std::min(box.x1, i + 1.0) - std::max(box.x0, double(i));
      const double h = std::min(box.y1, j + 1.0) - std::max(box.y0, double(j));
      if (w > 0 && h > 0) sum += w * h * image.value(i, j);
    }
  return sum;
}

TEST(SummedAreaTable, BoxesWithFractionalCornersAreExact) {
  const SummedAreaTable image = random_image(23, 17, 1);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> x(-3, 26), y(-3, 20);
  for (int k = 0; k < 2000; ++k) {
    PixelBox box{x(random), x(random), y(random), y(random)};
    if (box.x1 < box.x0) std::swap(box.x0, box.x1);
    if (box.y1 < box.y0) std::swap(box.y0, box.y1);
    EXPECT_NEAR(image.integral(image.clipped(box)), summed(image, box), 1e-12 * image.total());
  }
  EXPECT_EQ(image.integral({3, 3, 2, 9}), 0);
  EXPECT_EQ(image.integral({5, 4, 2, 9}), 0);
}

TEST(SummedAreaTable, ASmallBoxOfABrightFourThousandPixelImageKeepsItsDigits) {
  constexpr int width = 4096, height = 2160;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> pixels;
  for (int k = 0; k < width * height; ++k) pixels.push_back(1e4 * unit(random));
  pixels[1000] = 1e10;
  const SummedAreaTable image(pixels, width, height);
  const PixelBox box{4000.25, 4002.75, 2100.5, 2103.25};
  // The sum of all is 5e10 here: 2⁻⁵³ of it is 6e-6, of a box that holds 3e4.
  EXPECT_NEAR(image.integral(box), summed(image, box), 1e-3);
  EXPECT_GT(summed(image, box), 1e4);
}

const PixelBox boxes[] = {
    {2.5, 9.25, 1.75, 5.5}, {0, 12, 0, 9}, {-4, 3.5, 6.25, 30}, {4.25, 4.75, 3.1, 3.9}, {7, 8, 2, 8.5}};

TEST(BoxDistribution, DrawsTheImageWithinTheBox) {
  const SummedAreaTable image = random_image(12, 9, 4);
  unsigned seed = 5;
  for (const PixelBox& box : boxes) {
    const BoxDistribution distribution(image, box);
    const PixelBox in = distribution.box();
    const double all = summed(image, in);
    EXPECT_NEAR(distribution.integral(), all, 1e-12);
    for (const auto inversion : {Inversion::secant, Inversion::bisection}) {
      const ChiSquare test = chi_square_2d(
          {in.x0, in.x1, in.y0, in.y1, 24, 18, 16}, 50000, seed++,
          [&](double xi1, double xi2, double& x, double& y) {
            const auto point = distribution.sample(xi1, xi2, inversion);
            if (!point) return false;
            EXPECT_GT(image.value(point->i, point->j), 0) << "no sample without light";
            x = point->x, y = point->y;
            return true;
          },
          [&](double x, double y) { return image.value(int(x), int(y)) / all; });
      EXPECT_TRUE(test.plausible()) << test.text();
    }
  }
}

TEST(BoxDistribution, TheDensityIntegratesToOne) {
  const SummedAreaTable image = random_image(12, 9, 6);
  for (const PixelBox& box : boxes) {
    const BoxDistribution distribution(image, box);
    const PixelBox in = distribution.box();
    double sum = 0;
    constexpr int n = 700;
    const double cell = (in.x1 - in.x0) * (in.y1 - in.y0) / n / n;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        sum +=
            cell * distribution.pdf(in.x0 + (i + 0.5) * (in.x1 - in.x0) / n, in.y0 + (j + 0.5) * (in.y1 - in.y0) / n);
    EXPECT_NEAR(sum, 1, 0.01);
    EXPECT_EQ(distribution.pdf(in.x1 + 0.01, (in.y0 + in.y1) / 2), 0);
  }
}

TEST(BoxDistribution, InvertingUndoesSampling) {
  const SummedAreaTable image = random_image(12, 9, 7, 1e6);
  for (const PixelBox& box : boxes) {
    const BoxDistribution distribution(image, box);
    for (double xi1 = 0.003; xi1 < 1; xi1 += 0.041)
      for (double xi2 = 0.007; xi2 < 1; xi2 += 0.037) {
        const auto point = distribution.sample(xi1, xi2);
        ASSERT_TRUE(point);
        const auto unit = distribution.invert(point->x, point->y);
        EXPECT_NEAR(unit.xi1, xi1, 1e-8);
        EXPECT_NEAR(unit.xi2, xi2, 1e-8);
      }
  }
}

TEST(BoxDistribution, AnEstimateMeetsAClosedForm) {
  // The mean of x y over the box weighed by the image, pixel by pixel, against stratified samples.
  const SummedAreaTable image = random_image(12, 9, 8);
  const PixelBox box = boxes[0];
  double wanted = 0;
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 12; ++i) {
      const double a = std::max(box.x0, double(i)), b = std::min(box.x1, i + 1.0);
      const double c = std::max(box.y0, double(j)), d = std::min(box.y1, j + 1.0);
      if (b > a && d > c) wanted += image.value(i, j) * (b * b - a * a) / 2 * (d * d - c * c) / 2;
    }
  const BoxDistribution distribution(image, box);
  double sum = 0;
  constexpr int n = 400;
  for (int k = 0; k < n * n; ++k) {
    const auto point = distribution.sample((k % n + 0.5) / n, (k / n + 0.5) / n);
    sum += point->x * point->y * distribution.integral() / n / n;
  }
  EXPECT_NEAR(sum, wanted, 1e-3 * wanted);
}

TEST(BoxDistribution, DarkAndMissedBoxesAreEmpty) {
  const SummedAreaTable dark(std::vector<double>(12, 0.0), 4, 3), image = random_image(4, 3, 9);
  EXPECT_FALSE(BoxDistribution(dark, {0, 4, 0, 3}).sample(0.5, 0.5));
  EXPECT_EQ(BoxDistribution(dark, {0, 4, 0, 3}).integral(), 0);
  for (const PixelBox& box : {PixelBox{5, 7, 0, 3}, {1, 1, 0, 3}, {-3, -1, -2, -1}}) {
    EXPECT_FALSE(BoxDistribution(image, box).sample(0.5, 0.5));
    EXPECT_EQ(BoxDistribution(image, box).integral(), 0);
  }
}

}  // namespace
}  // namespace lumifield
