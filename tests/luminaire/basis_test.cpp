#include "luminaire/basis.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lumifield {
namespace {

constexpr BasisKind kinds[] = {BasisKind::box, BasisKind::tent, BasisKind::bell, BasisKind::bspline2};

/// Midpoint sum with n points over [a, b].
template <class F>
double midpoint(F f, double a, double b, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += f(a + (b - a) * (i + 0.5) / n);
  return sum * (b - a) / n;
}

class BasisOf : public testing::TestWithParam<BasisKind> {};
INSTANTIATE_TEST_SUITE_P(All, BasisOf, testing::ValuesIn(kinds),
                         [](const auto& each) { return std::string(to_string(each.param)); });

TEST_P(BasisOf, ShiftsSumToOne) {
  const Basis basis(GetParam());
  for (double x = -0.499; x < 0.5; x += 0.0173) {
    double sum = 0;
    for (int j = -3; j <= 3; ++j) sum += basis(x - j);
    EXPECT_NEAR(sum, 1, 1e-14) << "at " << x;
  }
}

TEST_P(BasisOf, ReproducesPolynomialsToItsDegree) {
  const Basis basis(GetParam());
  const int degree = GetParam() == BasisKind::tent ? 1 : GetParam() == BasisKind::bspline2 ? 2 : 0;
  // Σ_j c_j φ(x − j) = x^degree with c_j = j^degree − (second moment of φ for degree 2).
  const double second = basis.moment(2, -9, 9);
  double worst = 0, worst_next = 0;
  for (double x = 0; x < 1; x += 0.01) {
    double sum = 0, next = 0;
    for (int j = -4; j <= 5; ++j) {
      sum += (std::pow(j, degree) - (degree == 2 ? second : 0)) * basis(x - j);
      next += std::pow(j, degree + 1) * basis(x - j);
    }
    worst = std::max(worst, std::abs(sum - std::pow(x, degree)));
    worst_next = std::max(worst_next, std::abs(next - std::pow(x, degree + 1)));
  }
  EXPECT_LT(worst, 1e-13);
  EXPECT_GT(worst_next, 1e-3) << "reproduces more than the table says";
}

TEST_P(BasisOf, MomentsAreIntegrals) {
  const Basis basis(GetParam());
  for (int k = 0; k <= 2; ++k)
    for (double a = -1.6; a < 1.5; a += 0.37) {
      const double b = a + 0.61;
      EXPECT_NEAR(basis.moment(k, a, b), midpoint([&](double t) { return std::pow(t, k) * basis(t); }, a, b, 200000), 2e-6);
      EXPECT_EQ(basis.moment(k, b, a), -basis.moment(k, a, b));
    }
  EXPECT_NEAR(basis.moment(0, -9, 9), 1, 1e-15);
  EXPECT_NEAR(basis.moment(1, -9, 9), 0, 1e-15);
}

TEST_P(BasisOf, MomentsOfTinyIntervalsDoNotCancel) {
  const Basis basis(GetParam());
  const double x = 0.3, h = 1e-12;
  EXPECT_NEAR(basis.moment(0, x, x + h) / (basis(x) * ((x + h) - x)), 1, 1e-11);
}

TEST_P(BasisOf, NameRoundTrip) { EXPECT_EQ(basis_from_string(to_string(GetParam())), GetParam()); }

TEST(Dual, IsBiorthogonalToEveryShift) {
  for (const auto& [kind, window] : {std::pair{BasisKind::bell, 4}, {BasisKind::bell, 2}, {BasisKind::bspline2, 5},
                                     {BasisKind::tent, 4}, {BasisKind::box, 1}}) {
    const Dual dual(kind, window);
    for (int j = -4; j <= 4; ++j) {
      const double product = midpoint([&](double x) { return dual(x) * dual.basis()(x - j); }, -6, 6, 480000);
      EXPECT_NEAR(product, j == 0 ? 1 : 0, 2e-5) << to_string(kind) << " window " << window << " shift " << j;
    }
  }
}

/// Figures of the least-norm duals, derived independently of this code.
TEST(Dual, HasTheKnownScales) {
  struct Row { BasisKind kind; int window; double k_positive, k_negative; };
  for (const Row& row : {Row{BasisKind::bell, 4, 1.879, 0.300}, Row{BasisKind::bell, 2, 2.07, 0.629},
                         Row{BasisKind::bspline2, 5, 3.49, 1.34}, Row{BasisKind::tent, 4, 3.06, 0.875},
                         Row{BasisKind::box, 1, 1, 0}}) {
    const Dual dual(row.kind, row.window);
    EXPECT_NEAR(dual.k_positive(), row.k_positive, 0.006) << to_string(row.kind);
    EXPECT_NEAR(dual.k_negative(), row.k_negative, 0.006) << to_string(row.kind);
  }
}

TEST(Dual, BellCoefficients) {
  const Dual dual(BasisKind::bell, 4);
  ASSERT_EQ(dual.coefficients().size(), 5u);
  EXPECT_NEAR(dual.coefficients()[2], 1.370924, 1e-6);
  EXPECT_NEAR(dual.coefficients()[1], -0.218750, 1e-6);
  EXPECT_NEAR(dual.coefficients()[0], 0.066576, 1e-6);
}

}  // namespace
}  // namespace lumifield
