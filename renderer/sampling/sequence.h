#pragma once

#include <cstdint>
#include <vector>

namespace lumifield {

/// A point of the unit square, in [0, 1)².
struct UnitPoint {
  float x, y;
};

/// The mirror of i's digits in base b about the point (van der Corput 1935).
double radical_inverse(unsigned base, std::uint64_t i);

/// Points 0 … n−1 of the Halton sequence in bases 2 and 3: every prefix is well spread.
std::vector<UnitPoint> halton_points(int n);
/// n points of the Mersenne twister (Matsumoto, Nishimura 1998), the reference of independent numbers.
std::vector<UnitPoint> twister_points(int n, std::uint32_t seed);

/// The permuted congruential hash of 32 bits that Jarzynski and Olano 2020 recommend for graphics; the kernels have the
/// same one.
std::uint32_t hash(std::uint32_t v);
std::uint32_t hash(std::uint32_t a, std::uint32_t b, std::uint32_t c);
/// The upper 24 bits as a number in [0, 1), exact in float.
float unit(std::uint32_t bits);

/// Which points the samples of a cell and receiver are: of the Halton sequence the first ones for all; of the twister a
/// stretch of a table of at least 65,536 that begins anywhere, so that cells and receivers are independent. Value type.
enum class PointSequence { halton, twister };
class PointSet {
 public:
  /// most: samples of one cell and receiver; none of them is the same point.
  PointSet(PointSequence sequence, double most, std::uint32_t seed);
  /// Point k, moved by the cell's shift.
  UnitPoint at(std::uint32_t cell, std::uint32_t receiver, int k) const;

  const std::vector<UnitPoint>& points() const { return points_; }

 private:
  PointSequence sequence_;
  std::uint32_t seed_;
  std::vector<UnitPoint> points_;
};

/// A point moved on the torus (Cranley, Patterson 1976): uniformly distributed where the shift is.
UnitPoint rotated(UnitPoint point, UnitPoint shift);
/// The shift of a cell in a run: each cell has its own, so that the cells' errors are independent; all receivers share
/// it, as in Lu 2015 Sec. 6.3.
UnitPoint cell_shift(std::uint32_t seed, std::uint32_t cell);
/// The offset of a receiver's systematic rounding in a run.
float rounding_offset(std::uint32_t seed, std::uint32_t receiver);

}  // namespace lumifield
