// One number for each joint of an arm, and vectors of such numbers: arithmetic runs over all joints
// at once, in the same order whatever the width of the processor's registers.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>

namespace limber::dynamics {

/// One number a joint, base to tip. N: room for so many joints; what is beyond the arm's own is
/// zero or of no meaning. Everything here may be called in the cycle.
template <int N>
struct RowType {
  using type [[gnu::vector_size(N * sizeof(double))]] = double;
};
template <int N>
using Row = typename RowType<N>::type;

/// A vector a joint, by components.
template <int N>
struct Row3 {
  Row<N> x, y, z;

  void set(int i, const Eigen::Vector3d& v) noexcept { x[i] = v[0], y[i] = v[1], z[i] = v[2]; }
  Eigen::Vector3d at(int i) const noexcept { return {x[i], y[i], z[i]}; }
};

template <int N>
[[gnu::always_inline]] inline Row3<N> operator+(const Row3<N>& a, const Row3<N>& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <int N>
[[gnu::always_inline]] inline Row3<N> operator*(const Row<N>& s, const Row3<N>& a) noexcept {
  return {s * a.x, s * a.y, s * a.z};
}
template <int N>
[[gnu::always_inline]] inline Row3<N> cross(const Row3<N>& a, const Row3<N>& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <int N>
[[gnu::always_inline]] inline Row<N> dot(const Row3<N>& a, const Row3<N>& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A twist, or a momentum or wrench, a joint: linear and angular part.
template <int N>
struct Row6 {
  Row3<N> lin, ang;
};

template <int N>
[[gnu::always_inline]] inline Row6<N> operator+(const Row6<N>& a, const Row6<N>& b) noexcept {
  return {a.lin + b.lin, a.ang + b.ang};
}
template <int N>
[[gnu::always_inline]] inline Row6<N> operator*(const Row<N>& s, const Row6<N>& a) noexcept {
  return {s * a.lin, s * a.ang};
}
template <int N>
[[gnu::always_inline]] inline Row<N> dot(const Row6<N>& a, const Row6<N>& b) noexcept {
  return dot(a.lin, b.lin) + dot(a.ang, b.ang);
}

/// Lane i gets lane i + Shift, or zero.
template <int N, int Shift, std::size_t... I>
[[gnu::always_inline]] inline Row<N> shifted(const Row<N>& a, std::index_sequence<I...>) noexcept {
  constexpr auto from = [](int lane) { return lane >= 0 && lane < N ? lane : N; };
  return __builtin_shufflevector(a, Row<N>{}, from(static_cast<int>(I) + Shift)...);
}
/// Sums over 1, 2, 4, ... neighbours: so each lane's numbers are added in one order.
template <int N, int Shift>
[[gnu::always_inline]] inline Row<N> summed(const Row<N>& a) noexcept {
  if constexpr (Shift >= N || -Shift >= N) {
    return a;
  } else {
    return summed<N, 2 * Shift>(a + shifted<N, Shift>(a, std::make_index_sequence<N>()));
  }
}

/// Sum over the joints from the base to this one.
template <int N>
[[gnu::always_inline]] inline Row<N> from_base(const Row<N>& a) noexcept {
  return summed<N, -1>(a);
}
/// Sum over the joints from the tip to this one.
template <int N>
[[gnu::always_inline]] inline Row<N> from_tip(const Row<N>& a) noexcept {
  return summed<N, 1>(a);
}
template <int N>
[[gnu::always_inline]] inline Row3<N> from_base(const Row3<N>& a) noexcept {
  return {from_base<N>(a.x), from_base<N>(a.y), from_base<N>(a.z)};
}
template <int N>
[[gnu::always_inline]] inline Row3<N> from_tip(const Row3<N>& a) noexcept {
  return {from_tip<N>(a.x), from_tip<N>(a.y), from_tip<N>(a.z)};
}
template <int N>
[[gnu::always_inline]] inline Row6<N> from_base(const Row6<N>& a) noexcept {
  return {from_base<N>(a.lin), from_base<N>(a.ang)};
}
template <int N>
[[gnu::always_inline]] inline Row6<N> from_tip(const Row6<N>& a) noexcept {
  return {from_tip<N>(a.lin), from_tip<N>(a.ang)};
}

/// A symmetric 3 x 3 matrix a joint.
template <int N>
struct RowSymmetric {
  Row<N> xx, yy, zz, xy, xz, yz;
};

template <int N>
[[gnu::always_inline]] inline Row3<N> operator*(const RowSymmetric<N>& A,
                                                const Row3<N>& b) noexcept {
  return {A.xx * b.x + A.xy * b.y + A.xz * b.z, A.xy * b.x + A.yy * b.y + A.yz * b.z,
          A.xz * b.x + A.yz * b.y + A.zz * b.z};
}
template <int N>
[[gnu::always_inline]] inline RowSymmetric<N> from_tip(const RowSymmetric<N>& A) noexcept {
  return {from_tip<N>(A.xx), from_tip<N>(A.yy), from_tip<N>(A.zz),
          from_tip<N>(A.xy), from_tip<N>(A.xz), from_tip<N>(A.yz)};
}

}  // namespace limber::dynamics
