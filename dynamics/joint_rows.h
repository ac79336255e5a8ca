// One number for each joint of an arm, and vectors of such numbers: arithmetic runs over all joints
// at once, in the same order whatever the width of the processor's registers.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstring>
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
[[gnu::always_inline]] inline Row3<N> operator-(const Row3<N>& a, const Row3<N>& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
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
template <int N, int Shift>
[[gnu::always_inline]] inline Row<N> shifted(const Row<N>& a) noexcept {
  return shifted<N, Shift>(a, std::make_index_sequence<N>());
}
/// Sums over 1, 2, 4, ... neighbours: so each lane's numbers are added in one order.
template <int N, int Shift>
[[gnu::always_inline]] inline Row<N> summed(const Row<N>& a) noexcept {
  if constexpr (Shift >= N || -Shift >= N) {
    return a;
  } else {
    return summed<N, 2 * Shift>(a + shifted<N, Shift>(a));
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

/// A pose a joint: the columns of its rotation, and its origin.
template <int N>
struct RowPose {
  Row3<N> R_x, R_y, R_z, p;

  void set(int i, const Eigen::Matrix3d& R, const Eigen::Vector3d& origin) noexcept {
    R_x.set(i, R.col(0)), R_y.set(i, R.col(1)), R_z.set(i, R.col(2)), p.set(i, origin);
  }
};

template <int N>
[[gnu::always_inline]] inline Row3<N> rotated(const RowPose<N>& X, const Row3<N>& a) noexcept {
  return a.x * X.R_x + a.y * X.R_y + a.z * X.R_z;
}
/// B, whose poses are given in the frames A.
template <int N>
[[gnu::always_inline]] inline RowPose<N> operator*(const RowPose<N>& A,
                                                   const RowPose<N>& B) noexcept {
  return {rotated(A, B.R_x), rotated(A, B.R_y), rotated(A, B.R_z), A.p + rotated(A, B.p)};
}
/// f of each row of one pose, or of two: M joints.
template <int M, typename F, typename... Poses>
[[gnu::always_inline]] inline RowPose<M> each_row(const F& f, const Poses&... X) noexcept {
  const auto each = [&](const auto&... a) -> Row3<M> { return {f(a.x...), f(a.y...), f(a.z...)}; };
  return {each(X.R_x...), each(X.R_y...), each(X.R_z...), each(X.p...)};
}
/// Lane i gets the pose of lane i - Joints, or that of the base.
template <int N, int Joints>
[[gnu::always_inline]] inline RowPose<N> before(const RowPose<N>& X) noexcept {
  RowPose<N> B = each_row<N>([](const Row<N>& a) { return shifted<N, -Joints>(a); }, X);
  Row<N> base = Row<N>{};
  for (int i = 0; i < Joints; ++i) base[i] = 1.0;
  B.R_x.x += base, B.R_y.y += base, B.R_z.z += base;
  return B;
}
/// Each pose after those of the joints before it, base to this one: over 1, 2, 4 neighbours, and of
/// more than eight joints by halves, since g++ 12 moves lanes of what is wider than a register one
/// by one.
template <int N, int Neighbour = 1>
[[gnu::always_inline]] inline RowPose<N> from_base(const RowPose<N>& X, int joints) noexcept {
  if constexpr (N > 8) {
    constexpr int kHalf = N / 2;
    const auto half = [](int first) {
      return [first](const Row<N>& a) {
        Row<kHalf> out;
        std::memcpy(&out, reinterpret_cast<const double*>(&a) + first, sizeof out);
        return out;
      };
    };
    const auto joined = [](const Row<kHalf>& low, const Row<kHalf>& high) {
      Row<N> out;
      std::memcpy(&out, &low, sizeof low);
      std::memcpy(reinterpret_cast<double*>(&out) + kHalf, &high, sizeof high);
      return out;
    };
    const auto last = [](const Row<kHalf>& a) { return Row<kHalf>{} + a[kHalf - 1]; };
    const auto low = from_base<kHalf>(each_row<kHalf>(half(0), X), kHalf);
    const auto high = each_row<kHalf>(last, low) *
                      from_base<kHalf>(each_row<kHalf>(half(kHalf), X), joints - kHalf);
    return each_row<N>(joined, low, high);
  } else {
    if constexpr (Neighbour < N) {
      if (Neighbour < joints)
        return from_base<N, 2 * Neighbour>(before<N, Neighbour>(X) * X, joints);
    }
    return X;
  }
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
