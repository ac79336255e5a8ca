#include "dynamics/spd_solve.h"

#include <limits>

namespace limber::dynamics {

template <int Columns>
void solve_spd(const MatrixJ& M,
               Eigen::Matrix<double, Eigen::Dynamic, Columns, Eigen::ColMajor, kMaxJoints, Columns>*
                   X) noexcept {
  const auto n = M.rows();
  // By rows: all right-hand sides at once.
  using Sides = Eigen::Array<double, Columns, 1>;
  double L[kMaxJoints][kMaxJoints];
  double inverse_D[kMaxJoints];
  Sides Y[kMaxJoints];
  for (Eigen::Index i = 0; i < n; ++i) {
    Y[i] = X->row(i).transpose();
    double LD[kMaxJoints];  // row i of L D
    double d = M(i, i);
    for (Eigen::Index j = 0; j < i; ++j) {
      double sum = M(j, i);
      for (Eigen::Index k = 0; k < j; ++k) sum -= LD[k] * L[j][k];
      LD[j] = sum;
      L[i][j] = sum * inverse_D[j];
      d -= sum * L[i][j];
      Y[i] -= L[i][j] * Y[j];
    }
    inverse_D[i] = d > 0.0 ? 1.0 / d : std::numeric_limits<double>::quiet_NaN();
  }
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    Sides x = inverse_D[i] * Y[i];
    for (Eigen::Index k = i + 1; k < n; ++k) x -= L[k][i] * Y[k];
    Y[i] = x;
    X->row(i) = x.transpose();
  }
}

template void solve_spd(const MatrixJ& M, MatrixJ6* X) noexcept;
template void solve_spd(const MatrixJ& M, VectorJ* X) noexcept;

}  // namespace limber::dynamics
