// One number for each joint of an arm, and vectors of such numbers: arithmetic runs over all joints
// at once, in the same order whatever the width of the processor's registers.
#pragma once

#include <Eigen/Core>

namespace limber::controller {

/// One number a joint, base to tip. N: room for so many joints; what is beyond the arm's own is
/// zero or of no meaning. Everything here may be called in the cycle.
template <int N>
using Row = Eigen::Array<double, N, 1>;

/// A vector a joint, by components.
template <int N>
struct Row3 {
  Row<N> x, y, z;

  void set(int i, const Eigen::Vector3d& v) noexcept { x[i] = v[0], y[i] = v[1], z[i] = v[2]; }
  Eigen::Vector3d at(int i) const noexcept { return {x[i], y[i], z[i]}; }
};

template <int N>
Row3<N> operator+(const Row3<N>& a, const Row3<N>& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <int N>
Row3<N> operator*(const Row<N>& s, const Row3<N>& a) noexcept {
  return {s * a.x, s * a.y, s * a.z};
}
template <int N>
Row3<N> cross(const Row3<N>& a, const Row3<N>& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <int N>
Row<N> dot(const Row3<N>& a, const Row3<N>& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A twist, or a momentum or wrench, a joint: linear and angular part.
template <int N>
struct Row6 {
  Row3<N> lin, ang;
};

template <int N>
Row6<N> operator+(const Row6<N>& a, const Row6<N>& b) noexcept {
  return {a.lin + b.lin, a.ang + b.ang};
}
template <int N>
Row6<N> operator*(const Row<N>& s, const Row6<N>& a) noexcept {
  return {s * a.lin, s * a.ang};
}
template <int N>
Row<N> dot(const Row6<N>& a, const Row6<N>& b) noexcept {
  return dot(a.lin, b.lin) + dot(a.ang, b.ang);
}

/// Sum over the joints from the base to this one.
template <int N>
Row<N> from_base(const Row<N>& a) noexcept {
  Row<N> sum = a;
  for (int i = 1; i < N; ++i) sum[i] += sum[i - 1];
  return sum;
}
/// Sum over the joints from the tip to this one.
template <int N>
Row<N> from_tip(const Row<N>& a) noexcept {
  Row<N> sum = a;
  for (int i = N - 2; i >= 0; --i) sum[i] += sum[i + 1];
  return sum;
}
template <int N>
Row3<N> from_base(const Row3<N>& a) noexcept {
  return {from_base<N>(a.x), from_base<N>(a.y), from_base<N>(a.z)};
}
template <int N>
Row3<N> from_tip(const Row3<N>& a) noexcept {
  return {from_tip<N>(a.x), from_tip<N>(a.y), from_tip<N>(a.z)};
}
template <int N>
Row6<N> from_base(const Row6<N>& a) noexcept {
  return {from_base<N>(a.lin), from_base<N>(a.ang)};
}
template <int N>
Row6<N> from_tip(const Row6<N>& a) noexcept {
  return {from_tip<N>(a.lin), from_tip<N>(a.ang)};
}

/// A symmetric 3 x 3 matrix a joint.
template <int N>
struct RowSymmetric {
  Row<N> xx, yy, zz, xy, xz, yz;
};

template <int N>
Row3<N> operator*(const RowSymmetric<N>& A, const Row3<N>& b) noexcept {
  return {A.xx * b.x + A.xy * b.y + A.xz * b.z, A.xy * b.x + A.yy * b.y + A.yz * b.z,
          A.xz * b.x + A.yz * b.y + A.zz * b.z};
}
template <int N>
RowSymmetric<N> from_tip(const RowSymmetric<N>& A) noexcept {
  return {from_tip<N>(A.xx), from_tip<N>(A.yy), from_tip<N>(A.zz),
          from_tip<N>(A.xy), from_tip<N>(A.xz), from_tip<N>(A.yz)};
}

}  // namespace limber::controller
