#include "acquisition/virtual/quadrature.h"

#include <Eigen/Eigenvalues>

namespace lumifield::virtual_bench {

GaussRule::GaussRule(int n) : x(n), w(n) {
  // Golub and Welsch 1969: the nodes are the eigenvalues of the Legendre polynomials' recurrence.
  Eigen::VectorXd beside(n - 1);
  for (int k = 1; k < n; ++k) beside[k - 1] = k / std::sqrt(4.0 * k * k - 1);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> recurrence;
  recurrence.computeFromTridiagonal(Eigen::VectorXd::Zero(n), beside);
  Eigen::VectorXd::Map(x.data(), n) = recurrence.eigenvalues();
  Eigen::VectorXd::Map(w.data(), n) = 2 * recurrence.eigenvectors().row(0).array().square();
}

}  // namespace lumifield::virtual_bench
