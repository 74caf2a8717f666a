#include "renderer/sampling/sequence.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace lumifield {

double radical_inverse(unsigned base, std::uint64_t i) {
  double inverse = 0, digit = 1.0 / base;
  for (; i > 0; i /= base, digit /= base) inverse += digit * static_cast<double>(i % base);
  return inverse;
}

namespace {

/// Rounding to float must not reach 1.
float below_one(double x) { return std::min(static_cast<float>(x), 0x1.fffffep-1f); }

}  // namespace

std::vector<UnitPoint> halton_points(int n) {
  std::vector<UnitPoint> points;
  points.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i)
    points.push_back({below_one(radical_inverse(2, static_cast<std::uint64_t>(i))),
                      below_one(radical_inverse(3, static_cast<std::uint64_t>(i)))});
  return points;
}

std::vector<UnitPoint> twister_points(int n, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<UnitPoint> points;
  points.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const float x = unit(static_cast<std::uint32_t>(random()));
    points.push_back({x, unit(static_cast<std::uint32_t>(random()))});
  }
  return points;
}

std::uint32_t hash(std::uint32_t v) {
  const std::uint32_t state = v * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
  return (word >> 22) ^ word;
}

std::uint32_t hash(std::uint32_t a, std::uint32_t b, std::uint32_t c) { return hash(a + hash(b + hash(c))); }

float unit(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

PointSet::PointSet(PointSequence sequence, double most, std::uint32_t seed) : sequence_(sequence), seed_(seed) {
  constexpr int least_table = 1 << 16;
  const int all = static_cast<int>(std::ceil(most)) + 1;
  points_ = sequence == PointSequence::twister ? twister_points(std::max(all, least_table), seed) : halton_points(all);
}

UnitPoint PointSet::at(std::uint32_t cell, std::uint32_t receiver, int k) const {
  const std::size_t first = sequence_ == PointSequence::twister ? hash(cell, receiver, hash(seed_)) : 0;
  return rotated(points_[(first + static_cast<std::size_t>(k)) % points_.size()], cell_shift(seed_, cell));
}

UnitPoint rotated(UnitPoint point, UnitPoint shift) {
  const float x = point.x + shift.x, y = point.y + shift.y;
  return {x >= 1 ? x - 1 : x, y >= 1 ? y - 1 : y};
}

UnitPoint cell_shift(std::uint32_t seed, std::uint32_t cell) {
  return {unit(hash(1, cell, seed)), unit(hash(2, cell, seed))};
}

float rounding_offset(std::uint32_t seed, std::uint32_t receiver) { return unit(hash(3, receiver, seed)); }

}  // namespace lumifield
