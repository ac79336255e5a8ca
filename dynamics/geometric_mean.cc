#include "dynamics/geometric_mean.h"

#include <algorithm>
#include <cmath>

#include "common/joints.h"
#include "dynamics/each_processor.h"
#include "dynamics/row_solve.h"

namespace limber::dynamics {
namespace {

constexpr int kSteps = 12;
// What A and B may differ by in the last step: half its square is left in their mean.
constexpr double kClose = 1e-7;
// Share of a row that rounding leaves where there is nothing.
constexpr double kSingular = 1e-13;

/// A matrix by rows, n of them; what is beyond is zero.
template <int N>
using Rows = double[N][N];

/// Whether elimination leaves something of each row; S is lost.
template <int N>
[[gnu::always_inline]] inline bool regular_rows(int n, Rows<N>& S) noexcept {
  for (int k = 0; k < n; ++k) {
    const double over = 1.0 / S[k][k];
    for (int i = k + 1; i < n; ++i) {
      const double before = S[i][i], factor = S[i][k] * over;
      for (int l = 0; l < N; ++l) S[i][l] -= factor * S[k][l];
      if (!(S[i][i] > kSingular * before)) return false;
    }
  }
  return true;
}

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
  eliminate(n, S, [&](const auto& x, const auto& y, const auto& Dx, const auto& Dy) {
    for (int i = 0; i < n; ++i) {
      const double f = x[N + i], g = y[N + i];
      for (int l = 0; l < N; ++l) product[i][l] += f * Dx[2 * N + l] + g * Dy[2 * N + l];
    }
  });
  for (int i = 0; i < n; ++i) {
    for (int l = 0; l < N; ++l) {
      A[i][l] = 0.5 * (A[i][l] + B[i][l]);
      B[i][l] = 2.0 * product[i][l];
    }
    // What the product lacks of symmetry is rounding, which must not grow.
    for (int k = 0; k < i; ++k) B[k][i] = B[i][k];
  }
}

template <int N>
[[gnu::always_inline]] inline bool mean_rows(const Eigen::Ref<const Eigen::MatrixXd>& P,
                                             const Eigen::Ref<const Eigen::MatrixXd>& Q,
                                             Eigen::Ref<Eigen::MatrixXd> G) noexcept {
  const int n = static_cast<int>(P.rows());
  Rows<N> A = {}, B = {}, S = {};
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k <= i; ++k) {
      A[i][k] = A[k][i] = P(i, k);
      S[i][k] = S[k][i] = B[i][k] = B[k][i] = Q(i, k);
    }
  }
  if (!regular_rows<N>(n, S)) return false;
  for (int steps = 0; steps < kSteps; ++steps) {
    const Ratios r = ratios<N>(n, A, B);
    if (!(r.least > 0.0 && std::isfinite(r.most))) return false;
    // From the first step on A - B is positive semidefinite: no entry exceeds its diagonal.
    if (steps > 0 && r.most - 1.0 <= kClose) {
      for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) G(k, i) = 0.5 * (A[i][k] + B[i][k]);
      }
      return true;
    }
    const double c = std::sqrt(std::sqrt(r.least * r.most));
    for (int i = 0; i < n; ++i) {
      for (int l = 0; l < N; ++l) A[i][l] *= 1.0 / c, B[i][l] *= c;
    }
    step<N>(n, A, B);
  }
  return false;
}

template <int N>
bool mean_of(const Eigen::Ref<const Eigen::MatrixXd>& P, const Eigen::Ref<const Eigen::MatrixXd>& Q,
             Eigen::Ref<Eigen::MatrixXd> G) noexcept;

#define LIMBER_MEAN_OF(N)                                                           \
  template <>                                                                       \
  LIMBER_EACH_PROCESSOR bool mean_of<N>(const Eigen::Ref<const Eigen::MatrixXd>& P, \
                                        const Eigen::Ref<const Eigen::MatrixXd>& Q, \
                                        Eigen::Ref<Eigen::MatrixXd> G) noexcept {   \
    return mean_rows<N>(P, Q, G);                                                   \
  }
LIMBER_MEAN_OF(8)
LIMBER_MEAN_OF(kMaxJoints)
#undef LIMBER_MEAN_OF

}  // namespace

bool geometric_mean(const Eigen::Ref<const Eigen::MatrixXd>& P,
                    const Eigen::Ref<const Eigen::MatrixXd>& Q,
                    Eigen::Ref<Eigen::MatrixXd> G) noexcept {
  return P.rows() <= 8 ? mean_of<8>(P, Q, G) : mean_of<kMaxJoints>(P, Q, G);
}

}  // namespace limber::dynamics
