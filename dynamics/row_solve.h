// Systems of equations by rows. Plain arrays: over their lanes the compiler runs as wide as the
// processor allows, while single lanes serve as factors.
#pragma once

#include <algorithm>
#include <limits>

#include "dynamics/level.h"

namespace limber::dynamics::LIMBER_LEVEL {

/// 1 / pivot; not a number where the pivot is not positive and finite.
[[gnu::always_inline]] inline double inverse_pivot(double pivot) noexcept {
  using Limits = std::numeric_limits<double>;
  return pivot > 0.0 && pivot <= Limits::max() ? 1.0 / pivot : Limits::quiet_NaN();
}

/// Eliminates the n rows [S X] of A, S symmetric positive definite, two at a time without pivoting:
/// what divisions there are wait for one another, and so they are half as many. Row n has
/// to be zero if n is odd; lanes n to N count for nothing. A becomes D^-1 L^-1 [S X], S = L D L^T
/// by blocks of two. each_pair(x, y, Dx, Dy): two rows of L^-1 [S X], and what they become; the sum
/// of their products is X^T S^-1 X. Gives values that are not finite where S is not positive
/// definite or not finite.
template <int N, int Lanes, typename EachPair>
[[gnu::always_inline]] inline void eliminate(int n, double (&A)[N][Lanes],
                                             const EachPair& each_pair) noexcept {
  if (n > N) __builtin_unreachable();
  if (n % 2 == 1) A[n][n] = 1.0;
  for (int k = 0; k < n; k += 2) {
    const double a = A[k][k], b = A[k + 1][k], c = A[k + 1][k + 1];
    const double over = inverse_pivot(a > 0.0 ? a * c - b * b : a);
    const double p = c * over, q = -b * over, r = a * over;
    double Dx[Lanes], Dy[Lanes];
    for (int l = 0; l < Lanes; ++l) {
      Dx[l] = p * A[k][l] + q * A[k + 1][l];
      Dy[l] = q * A[k][l] + r * A[k + 1][l];
    }
    for (int i = k + 2; i < n; ++i) {
      const double f = A[i][k], g = A[i][k + 1];
      for (int l = 0; l < Lanes; ++l) A[i][l] -= f * Dx[l] + g * Dy[l];
    }
    each_pair(A[k], A[k + 1], Dx, Dy);
    std::copy_n(Dx, Lanes, A[k]), std::copy_n(Dy, Lanes, A[k + 1]);
  }
}

/// X of [S X], n rows, by S^-1 X; likewise.
template <int N, int Columns>
[[gnu::always_inline]] inline void substitute(int n, double (&A)[N][N + Columns]) noexcept {
  for (int k = n - 1; k > 1; --k) {
    for (int i = (k & ~1) - 1; i >= 0; --i) {
      const double f = A[i][k];
      for (int l = N; l < N + Columns; ++l) A[i][l] -= f * A[k][l];
    }
  }
}

}  // namespace limber::dynamics::LIMBER_LEVEL
