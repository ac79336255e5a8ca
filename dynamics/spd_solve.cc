#include "dynamics/spd_solve.h"

#include "dynamics/each_processor.h"
#include "dynamics/row_solve.h"

namespace limber::dynamics {
namespace {

constexpr int kColumns = 8;  // of which six, or one, are used

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

template <int N>
[[gnu::always_inline]] inline void solve_one(const MatrixJ& M, VectorJ* X) noexcept {
  System<N> system(M);
  const int n = system.n;
  for (int i = 0; i < n; ++i) system.rows[i][N] = (*X)[i];
  eliminate(n, system.rows, [](const auto&...) {});
  substitute<N, kColumns>(n, system.rows);
  for (int i = 0; i < n; ++i) (*X)[i] = system.rows[i][N];
}

template <int N>
[[gnu::always_inline]] inline void solve_tip(const MatrixJ& M, const Matrix6J& J, MatrixJ6* X,
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

}  // namespace

LIMBER_EACH_PROCESSOR void solve_spd(const MatrixJ& M, VectorJ* X) noexcept {
  if (M.rows() <= 8) {
    solve_one<8>(M, X);
  } else {
    solve_one<kMaxJoints>(M, X);
  }
}

LIMBER_EACH_PROCESSOR void solve_spd(const MatrixJ& M, const Matrix6J& J, MatrixJ6* Minv_JT,
                                     Matrix6* G) noexcept {
  if (M.rows() <= 8) {
    solve_tip<8>(M, J, Minv_JT, G);
  } else {
    solve_tip<kMaxJoints>(M, J, Minv_JT, G);
  }
}

LIMBER_EACH_PROCESSOR Matrix6 inverse_spd(const Matrix6& G) noexcept {
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

}  // namespace limber::dynamics
