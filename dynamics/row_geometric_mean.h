// The mean of geometric_mean.h, of at most N rows.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "dynamics/row_solve.h"

namespace limber::dynamics::LIMBER_LEVEL {

constexpr int kSteps = 12;
// What A and B may differ by in the last step: half its square is left in their mean.
constexpr double kClose = 1e-7;
// A step leaves less than this share of a difference, but half of it where a part is singular.
constexpr double kLeft = 0.3;
// Share of a row that rounding leaves where there is nothing.
constexpr double kRounding = 1e-12;
constexpr double kLargest = std::numeric_limits<double>::max();

/// A matrix by rows, n of them; what is beyond is zero.
template <int N>
using Rows = double[N][N];

/// A symmetric matrix of which the lower half is given.
template <int N>
[[gnu::always_inline]] inline void take_lower(const Eigen::Ref<const Eigen::MatrixXd>& from,
                                              Rows<N>& to) noexcept {
  for (int i = 0; i < from.rows(); ++i) {
    for (int k = 0; k <= i; ++k) to[i][k] = to[k][i] = from(i, k);
  }
}

/// F, of `rank` columns, with Q = F F^T.
template <int N>
struct Factor {
  Rows<N> F = {};
  int rank = 0;

  /// By Cholesky steps, the row first of which the greatest share is left. Rank is below zero where
  /// Q is not positive semidefinite, or not finite.
  [[gnu::always_inline]] inline explicit Factor(int n, const Rows<N>& Q) noexcept {
    Rows<N> left;
    std::copy_n(&Q[0][0], N * N, &left[0][0]);
    for (; rank < n; ++rank) {
      int pivot = 0;
      double share = 0.0;
      for (int i = 0; i < n; ++i) {
        const bool fits = left[i][i] >= -kRounding * Q[i][i] && left[i][i] <= kLargest;
        if (!fits) share = -1.0;
        if (share < 0.0 || !(left[i][i] > share * Q[i][i])) continue;
        pivot = i, share = left[i][i] / Q[i][i];
      }
      if (share < 0.0 || (share <= kRounding && !nothing(n, left, Q))) rank = -1;
      if (!(share > kRounding)) return;
      const double over = 1.0 / std::sqrt(left[pivot][pivot]);
      double column[N];
      for (int l = 0; l < N; ++l) column[l] = over * left[pivot][l];
      for (int i = 0; i < n; ++i) {
        F[i][rank] = column[i];
        for (int l = 0; l < N; ++l) left[i][l] -= column[i] * column[l];
      }
    }
  }

 private:
  /// No entry is left that a semidefinite rest of so small a diagonal cannot have.
  [[gnu::always_inline]] static inline bool nothing(int n, const Rows<N>& left,
                                                    const Rows<N>& Q) noexcept {
    constexpr double kMost = 10.0 * kRounding;
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < i; ++k) {
        if (!(left[i][k] * left[i][k] <= kMost * Q[i][i] * (kMost * Q[k][k]))) return false;
      }
    }
    return true;
  }
};

/// The least and the greatest ratio of the diagonals' entries, A over B.
struct Ratios {
  double least, most;
};
template <int N>
[[gnu::always_inline]] inline Ratios ratios(int n, const Rows<N>& A, const Rows<N>& B) noexcept {
  Ratios r = {A[0][0] / B[0][0], A[0][0] / B[0][0]};
  for (int i = 1; i < n; ++i) {
    const double ratio = A[i][i] / B[i][i];
    r = {std::min(r.least, ratio), std::max(r.most, ratio)};
  }
  return r;
}

/// For eliminate(): adds X^T S^-1 Y to `product`, X and Y the columns from N and from `Y` on.
template <int N, int Y>
[[gnu::always_inline]] inline auto adding_to(Rows<N>& product, int n) noexcept {
  return [&product, n](const auto& x, const auto& y, const auto& Dx, const auto& Dy) {
    for (int i = 0; i < n; ++i) {
      const double f = x[N + i], g = y[N + i];
      for (int l = 0; l < N; ++l) product[i][l] += f * Dx[Y + l] + g * Dy[Y + l];
    }
  };
}

/// A, B <- (A + B) / 2, 2 A (A + B)^-1 B.
template <int N>
[[gnu::always_inline]] inline void step(int n, Rows<N>& A, Rows<N>& B) noexcept {
  double S[N][3 * N];  // [A + B, A, B]
  Rows<N> product = {};
  for (int i = 0; i < N; ++i) {
    for (int l = 0; l < N; ++l) {
      S[i][l] = A[i][l] + B[i][l], S[i][N + l] = A[i][l], S[i][2 * N + l] = B[i][l];
    }
  }
  eliminate(n, S, adding_to<N, 2 * N>(product, n));
  for (int i = 0; i < n; ++i) {
    for (int l = 0; l < N; ++l) {
      A[i][l] = 0.5 * (A[i][l] + B[i][l]);
      B[i][l] = 2.0 * product[i][l];
    }
  }
}

/// A becomes the mean of A and B, or false; B is lost.
template <int N>
[[gnu::always_inline]] inline bool converge(int n, Rows<N>& A, Rows<N>& B) noexcept {
  double before = 0.0;
  for (int steps = 0; steps < kSteps; ++steps) {
    const Ratios r = ratios<N>(n, A, B);
    if (!(r.least > 0.0 && std::isfinite(r.most))) return false;
    // From the first step on A - B is positive semidefinite: no entry exceeds its diagonal.
    if (steps > 0 && r.most - 1.0 <= kClose) {
      for (int i = 0; i < n; ++i) {
        for (int l = 0; l < N; ++l) A[i][l] = 0.5 * (A[i][l] + B[i][l]);
      }
      return true;
    }
    if (steps > 2 && r.most - 1.0 > kLeft * (before - 1.0) && Factor<N>(n, B).rank < n)
      return false;
    before = r.most;
    const double c = std::sqrt(std::sqrt(r.least * r.most));
    for (int i = 0; i < n; ++i) {
      for (int l = 0; l < N; ++l) A[i][l] *= 1.0 / c, B[i][l] *= c;
    }
    step<N>(n, A, B);
  }
  return false;
}

/// X^T S^-1 X, added to `product`.
template <int N>
[[gnu::always_inline]] inline void congruent(int n, const Rows<N>& S, const Rows<N>& X,
                                             Rows<N>& product) noexcept {
  double rows[N][2 * N];
  for (int i = 0; i < N; ++i) {
    std::copy_n(S[i], N, rows[i]), std::copy_n(X[i], N, rows[i] + N);
  }
  eliminate(n, rows, adding_to<N, N>(product, N));
}

/// P # F F^T = F W^-1/2 F^T with W = F^T P^-1 F, F of fewer columns than rows.
template <int N>
[[gnu::always_inline]] inline bool mean_of_lower_rank(int n, const Rows<N>& P, const Rows<N>& Q,
                                                      Rows<N>& G) noexcept {
  const Factor<N> factor(n, Q);
  const int rank = factor.rank;
  if (rank < 0 || rank == n) return false;
  Rows<N> W = {}, one = {}, Y = {};
  for (int i = 0; i < rank; ++i) one[i][i] = 1.0;
  congruent<N>(n, P, factor.F, W);
  congruent<N>(rank, W, one, Y);
  if (rank > 0 && !converge<N>(rank, Y, one)) return false;
  for (int i = 0; i < n; ++i) {
    double row[N] = {};
    for (int k = 0; k < rank; ++k) {
      for (int l = 0; l < N; ++l) row[l] += factor.F[i][k] * Y[k][l];
    }
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < rank; ++k) G[i][j] += row[k] * factor.F[j][k];
    }
  }
  return true;
}

template <int N>
LIMBER_TARGET bool mean(const Eigen::Ref<const Eigen::MatrixXd>& P,
                        const Eigen::Ref<const Eigen::MatrixXd>& Q,
                        Eigen::Ref<Eigen::MatrixXd> G) noexcept {
  const int n = static_cast<int>(P.rows());
  Rows<N> A = {}, B = {};
  take_lower<N>(P, A);
  take_lower<N>(Q, B);
  if (!converge<N>(n, A, B)) {
    Rows<N> inertia = {}, spring = {};
    take_lower<N>(P, inertia);
    take_lower<N>(Q, spring);
    std::fill_n(&A[0][0], N * N, 0.0);
    if (!mean_of_lower_rank<N>(n, inertia, spring, A)) return false;
  }
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) G(k, i) = 0.5 * (A[i][k] + A[k][i]);
  }
  return true;
}

}  // namespace limber::dynamics::LIMBER_LEVEL
