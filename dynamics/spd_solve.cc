#include "dynamics/spd_solve.h"

#include "dynamics/each_processor.h"
#include "dynamics/row_solve.h"

namespace limber::dynamics {
namespace {

constexpr int kColumns = 8;  // of which six, or one, are used

template <int N, typename Sides>
[[gnu::always_inline]] inline void solve_by_rows(const MatrixJ& M, Sides* X) noexcept {
  const int n = static_cast<int>(M.rows());
  Row<N> S[N];
  Row<kColumns> Y[N];
  for (int i = 0; i < n; ++i) {
    S[i] = Row<N>{}, Y[i] = Row<kColumns>{};
    for (int k = 0; k < n; ++k) S[i][k] = M(k, i);
    for (int k = 0; k < X->cols(); ++k) Y[i][k] = (*X)(i, k);
  }
  solve_rows<N, kColumns>(n, S, Y);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < X->cols(); ++k) (*X)(i, k) = Y[i][k];
  }
}

}  // namespace

#define LIMBER_SOLVE_FOR(Sides)                                               \
  LIMBER_EACH_PROCESSOR void solve_spd(const MatrixJ& M, Sides* X) noexcept { \
    if (M.rows() <= 8) {                                                      \
      solve_by_rows<8>(M, X);                                                 \
    } else {                                                                  \
      solve_by_rows<kMaxJoints>(M, X);                                        \
    }                                                                         \
  }
LIMBER_SOLVE_FOR(MatrixJ6)
LIMBER_SOLVE_FOR(VectorJ)
#undef LIMBER_SOLVE_FOR

}  // namespace limber::dynamics
