// The systems of spd_solve.h, of at most N rows.
#pragma once

#include "common/types.h"
#include "dynamics/row_solve.h"

namespace limber::dynamics::LIMBER_LEVEL {

constexpr int kColumns = 8;  // of which six are used

/// Rows [M X]. What lies beyond M's columns are other numbers of it, which count for nothing: a
/// copy of one length is several times faster.
template <int N>
struct System {
  double rows[N][N + kColumns] = {};
  int n;

  [[gnu::always_inline]] inline explicit System(const MatrixJ& M) noexcept
      : n(static_cast<int>(M.rows())) {
    for (int i = 0; i < n; ++i) std::copy_n(M.data() + i * n, N, rows[i]);
  }
};

// The right-hand side is one more row of the symmetric matrix [M X; X^T .], beneath the others:
// half the lanes of [M X]. As eliminate(), with all but one product done while a division lasts.
template <int N>
LIMBER_TARGET void solve_one(const MatrixJ& M, VectorJ* X) noexcept {
  const int n = static_cast<int>(M.rows());
  alignas(64) double rows[N + 1][N];
  double* const b = rows[n];
  double x[N] = {};
  for (int i = 0; i < n; ++i) std::copy_n(M.data() + i * n, N, rows[i]);
  std::copy_n(X->data(), N, b);
  int k = 0;
  for (; k + 1 < n; k += 2) {
    double(&first)[N] = rows[k], (&second)[N] = rows[k + 1];
    const double p = first[k], q = second[k], r = second[k + 1];
    const double over = inverse_pivot(p > 0.0 ? p * r - q * q : p);
    double Dx[N], Dy[N];
    for (int l = 0; l < N; ++l) {
      Dx[l] = r * first[l] - q * second[l];
      Dy[l] = p * second[l] - q * first[l];
    }
    x[k] = over * (r * b[k] - q * b[k + 1]);
    x[k + 1] = over * (p * b[k + 1] - q * b[k]);
    for (int i = k + 2; i <= n; ++i) {
      const double f = rows[i][k], g = rows[i][k + 1];
      for (int l = 0; l < N; ++l) rows[i][l] -= over * (f * Dx[l] + g * Dy[l]);
    }
    for (int l = 0; l < N; ++l) first[l] = over * Dx[l], second[l] = over * Dy[l];
  }
  if (k < n) {
    x[k] = b[k] * inverse_pivot(rows[k][k]);
    for (int i = k - 1; i >= 0; --i) x[i] -= rows[i][k] * x[k];
  }
  for (k -= 2; k > 0; k -= 2) {
    for (int i = k - 1; i >= 0; --i) x[i] -= rows[i][k] * x[k] + rows[i][k + 1] * x[k + 1];
  }
  std::copy_n(x, N, X->data());
}

template <int N>
LIMBER_TARGET void solve_tip(const MatrixJ& M, const Matrix6J& J, MatrixJ6* X,
                             Matrix6* G) noexcept {
  System<N> system(M);
  const int n = system.n;
  for (int i = 0; i < n; ++i) std::copy_n(J.data() + 6 * i, 6, system.rows[i] + N);
  eliminate(n, system.rows, [](const auto&...) {});
  substitute<N, kColumns>(n, system.rows);
  for (int i = 0; i < n; ++i) std::copy_n(system.rows[i] + N, 6, X->data() + 6 * i);
  double sum[6][kColumns] = {};
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < 6; ++i) {
      const double f = J(i, k);
      for (int l = 0; l < kColumns; ++l) sum[i][l] += f * system.rows[k][N + l];
    }
  }
  for (int i = 0; i < 6; ++i) std::copy_n(sum[i], 6, G->data() + 6 * i);
}

LIMBER_TARGET inline Matrix6 inverse(const Matrix6& G) noexcept {
  double rows[8][8 + kColumns] = {};
  for (int i = 0; i < 6; ++i) {
    std::copy_n(G.data() + 6 * i, 6, rows[i]);
    rows[i][8 + i] = 1.0;
  }
  eliminate(6, rows, [](const auto&...) {});
  substitute<8, kColumns>(6, rows);
  Matrix6 inverse;
  for (int i = 0; i < 6; ++i) std::copy_n(rows[i] + 8, 6, inverse.data() + 6 * i);
  return inverse;
}

}  // namespace limber::dynamics::LIMBER_LEVEL
