// Systems of equations by rows: one row of the matrix, or of all right-hand sides, at a time.
#pragma once

#include <limits>

#include "dynamics/joint_rows.h"

namespace limber::dynamics {

/// X <- S^-1 X for the symmetric positive definite S of n rows, by elimination without pivoting; S
/// is lost. Gives values that are not finite where S is not positive definite or not finite. In the
/// cycle.
template <int N, int Columns>
[[gnu::always_inline]] inline void solve_rows(int n, Row<N> (&S)[N],
                                              Row<Columns> (&X)[N]) noexcept {
  double inverse_pivot[N];
  for (int k = 0; k < n; ++k) {
    const double pivot = S[k][k];
    inverse_pivot[k] = pivot > 0.0 ? 1.0 / pivot : std::numeric_limits<double>::quiet_NaN();
    for (int i = k + 1; i < n; ++i) {
      const double factor = S[i][k] * inverse_pivot[k];
      S[i] -= factor * S[k];
      X[i] -= factor * X[k];
    }
  }
  for (int i = n - 1; i >= 0; --i) {
    for (int k = i + 1; k < n; ++k) X[i] -= S[i][k] * X[k];
    X[i] *= inverse_pivot[i];
  }
}

}  // namespace limber::dynamics
