// One number for each joint of an arm, and vectors of such numbers: arithmetic runs over as many
// joints at once as a register holds, and adds in one order whatever its width.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "dynamics/level.h"

namespace limber::dynamics::LIMBER_LEVEL {

inline constexpr int kLanes = LIMBER_LANES;

/// One number a joint, base to tip. N: room for so many joints, 2 or a multiple of 4; what is
/// beyond the arm's own is zero or of no meaning. Everything here may be called in the cycle.
template <int N>
struct Row {
  static constexpr int kLow = N > 8 ? 8 : N / 2;
  Row<kLow> low;
  Row<N - kLow> high;
};
template <int N>
requires(N <= kLanes) struct Row<N> {
  using Lanes [[gnu::vector_size(N * sizeof(double))]] = double;
  using Whole [[gnu::vector_size(N * sizeof(double))]] = std::int64_t;
  using InMemory [[gnu::vector_size(N * sizeof(double)), gnu::aligned(8), gnu::may_alias]] = double;
  Lanes lanes;
};
template <int N>
inline constexpr bool kOneRegister = N <= kLanes;

template <int N>
[[gnu::always_inline]] inline double lane(const Row<N>& a, int i) noexcept {
  double number;
  std::memcpy(&number, reinterpret_cast<const double*>(&a) + i, sizeof number);
  return number;
}
template <int N>
[[gnu::always_inline]] inline void set_lane(Row<N>* a, int i, double number) noexcept {
  std::memcpy(reinterpret_cast<double*>(a) + i, &number, sizeof number);
}

// Not by memcpy(): g++ 12 moves 16 bytes at a time then, and a register that is read next waits.
template <int N>
[[gnu::always_inline]] inline Row<N> loaded(const double* from) noexcept {
  if constexpr (kOneRegister<N>)
    return {*reinterpret_cast<const typename Row<N>::InMemory*>(from)};
  else
    return {loaded<Row<N>::kLow>(from), loaded<N - Row<N>::kLow>(from + Row<N>::kLow)};
}
template <int N>
[[gnu::always_inline]] inline void store(const Row<N>& a, double* to) noexcept {
  if constexpr (kOneRegister<N>)
    *reinterpret_cast<typename Row<N>::InMemory*>(to) = a.lanes;
  else
    store(a.low, to), store(a.high, to + Row<N>::kLow);
}

/// Lanes whose bits in `mask` are not set become zero, whatever they were.
template <int N>
[[gnu::always_inline]] inline Row<N> operator&(const Row<N>& a, const Row<N>& mask) noexcept {
  if constexpr (kOneRegister<N>) {
    using Whole = typename Row<N>::Whole;
    return {reinterpret_cast<typename Row<N>::Lanes>(reinterpret_cast<Whole>(a.lanes) &
                                                     reinterpret_cast<Whole>(mask.lanes))};
  } else {
    return {a.low & mask.low, a.high & mask.high};
  }
}
template <int N>
[[gnu::always_inline]] inline Row<N> operator+(const Row<N>& a, const Row<N>& b) noexcept {
  if constexpr (kOneRegister<N>)
    return {a.lanes + b.lanes};
  else
    return {a.low + b.low, a.high + b.high};
}
template <int N>
[[gnu::always_inline]] inline Row<N> operator-(const Row<N>& a, const Row<N>& b) noexcept {
  if constexpr (kOneRegister<N>)
    return {a.lanes - b.lanes};
  else
    return {a.low - b.low, a.high - b.high};
}
template <int N>
[[gnu::always_inline]] inline Row<N> operator*(const Row<N>& a, const Row<N>& b) noexcept {
  if constexpr (kOneRegister<N>)
    return {a.lanes * b.lanes};
  else
    return {a.low * b.low, a.high * b.high};
}
template <int N>
[[gnu::always_inline]] inline Row<N> operator*(double s, const Row<N>& a) noexcept {
  if constexpr (kOneRegister<N>)
    return {s * a.lanes};
  else
    return {s * a.low, s * a.high};
}
template <int N>
[[gnu::always_inline]] inline Row<N> operator+(double s, const Row<N>& a) noexcept {
  if constexpr (kOneRegister<N>)
    return {s + a.lanes};
  else
    return {s + a.low, s + a.high};
}

/// Each lane of one half of 2, 4, ... lanes gets the sum of the other half, which is in its lane
/// next to this one; the other half stays.
template <bool FromBase, int N, int Half, std::size_t... I>
[[gnu::always_inline]] inline Row<N> carried(const Row<N>& a, std::index_sequence<I...>) noexcept {
  constexpr auto from = [](int lane) {
    const int middle = lane / (2 * Half) * 2 * Half + Half;
    if (FromBase) return lane >= middle ? middle - 1 : N;
    return lane < middle ? middle : N;
  };
  return {a.lanes +
          __builtin_shufflevector(a.lanes, typename Row<N>::Lanes{}, from(static_cast<int>(I))...)};
}
template <bool FromBase, int Half, int N>
[[gnu::always_inline]] inline Row<N> summed(const Row<N>& a) noexcept {
  if constexpr (Half == N)
    return a;
  else
    return summed<FromBase, 2 * Half>(carried<FromBase, N, Half>(a, std::make_index_sequence<N>()));
}

template <int N>
[[gnu::always_inline]] inline double first(const Row<N>& a) noexcept {
  if constexpr (kOneRegister<N>)
    return a.lanes[0];
  else
    return first(a.low);
}
template <int N>
[[gnu::always_inline]] inline double last(const Row<N>& a) noexcept {
  if constexpr (kOneRegister<N>)
    return a.lanes[N - 1];
  else
    return last(a.high);
}

/// Sum over the joints from the base to this one.
template <int N>
[[gnu::always_inline]] inline Row<N> from_base(const Row<N>& a) noexcept {
  if constexpr (kOneRegister<N>) {
    return summed<true, 1>(a);
  } else {
    const auto low = from_base(a.low);
    return {low, last(low) + from_base(a.high)};
  }
}
/// Sum over the joints from the tip to this one.
template <int N>
[[gnu::always_inline]] inline Row<N> from_tip(const Row<N>& a) noexcept {
  if constexpr (kOneRegister<N>) {
    return summed<false, 1>(a);
  } else {
    const auto high = from_tip(a.high);
    return {first(high) + from_tip(a.low), high};
  }
}

/// A vector a joint, by components.
template <int N>
struct Row3 {
  Row<N> x, y, z;

  void set(int i, const Eigen::Vector3d& v) noexcept {
    set_lane(&x, i, v[0]), set_lane(&y, i, v[1]), set_lane(&z, i, v[2]);
  }
  Eigen::Vector3d at(int i) const noexcept { return {lane(x, i), lane(y, i), lane(z, i)}; }
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
template <int N>
[[gnu::always_inline]] inline Row3<N> from_base(const Row3<N>& a) noexcept {
  return {from_base(a.x), from_base(a.y), from_base(a.z)};
}
template <int N>
[[gnu::always_inline]] inline Row3<N> from_tip(const Row3<N>& a) noexcept {
  return {from_tip(a.x), from_tip(a.y), from_tip(a.z)};
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
template <int N>
[[gnu::always_inline]] inline Row6<N> from_base(const Row6<N>& a) noexcept {
  return {from_base(a.lin), from_base(a.ang)};
}
template <int N>
[[gnu::always_inline]] inline Row6<N> from_tip(const Row6<N>& a) noexcept {
  return {from_tip(a.lin), from_tip(a.ang)};
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
  return {from_tip(A.xx), from_tip(A.yy), from_tip(A.zz),
          from_tip(A.xy), from_tip(A.xz), from_tip(A.yz)};
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

/// Of N joints one vector each, `Step` numbers apart, of four numbers the last of which counts for
/// nothing.
template <int N, int Step>
[[gnu::always_inline]] inline Row3<N> by_components(const double* of) noexcept {
  if constexpr (N == 2) {
    const auto xy = loaded<N>(of), more_xy = loaded<N>(of + Step);
    const auto z = loaded<N>(of + 2), more_z = loaded<N>(of + Step + 2);
    return {{__builtin_shufflevector(xy.lanes, more_xy.lanes, 0, 2)},
            {__builtin_shufflevector(xy.lanes, more_xy.lanes, 1, 3)},
            {__builtin_shufflevector(z.lanes, more_z.lanes, 0, 2)}};
  } else if constexpr (N == 4 && kOneRegister<N>) {
    const auto a = loaded<N>(of), b = loaded<N>(of + Step);
    const auto c = loaded<N>(of + 2 * Step), d = loaded<N>(of + 3 * Step);
    const auto xz = __builtin_shufflevector(a.lanes, b.lanes, 0, 4, 2, 6);
    const auto y = __builtin_shufflevector(a.lanes, b.lanes, 1, 5, 3, 7);
    const auto more_xz = __builtin_shufflevector(c.lanes, d.lanes, 0, 4, 2, 6);
    const auto more_y = __builtin_shufflevector(c.lanes, d.lanes, 1, 5, 3, 7);
    return {{__builtin_shufflevector(xz, more_xz, 0, 1, 4, 5)},
            {__builtin_shufflevector(y, more_y, 0, 1, 4, 5)},
            {__builtin_shufflevector(xz, more_xz, 2, 3, 6, 7)}};
  } else {
    constexpr int kLow = N > 8 ? 8 : N / 2;
    const auto low = by_components<kLow, Step>(of);
    const auto high = by_components<N - kLow, Step>(of + kLow * Step);
    const auto both = [](const auto& a, const auto& b) __attribute__((always_inline))->Row<N> {
      if constexpr (kOneRegister<N>)
        return {__builtin_shufflevector(a.lanes, b.lanes, 0, 1, 2, 3, 4, 5, 6, 7)};
      else
        return {a, b};
    };
    return {both(low.x, high.x), both(low.y, high.y), both(low.z, high.z)};
  }
}

inline constexpr double kUnit[4][4] = {{1.0}, {0.0, 1.0}, {0.0, 0.0, 1.0}};

/// Each pose after those of the joints before it, base to this one: joint by joint.
template <int N>
[[gnu::always_inline]] inline RowPose<N> from_base(const RowPose<N>& X, int joints) noexcept {
  alignas(64) double of[N][4][4];  // R's columns and p
  Row<4> R_x = loaded<4>(kUnit[0]), R_y = loaded<4>(kUnit[1]), R_z = loaded<4>(kUnit[2]);
  Row<4> p = loaded<4>(kUnit[3]);
  for (int i = 0; i < joints; ++i) {
    const auto turned = [&](const Row3<N>& a) __attribute__((always_inline)) {
      return lane(a.x, i) * R_x + lane(a.y, i) * R_y + lane(a.z, i) * R_z;
    };
    const Row<4> x = turned(X.R_x), y = turned(X.R_y), z = turned(X.R_z);
    p = p + turned(X.p), R_x = x, R_y = y, R_z = z;
    store(R_x, of[i][0]), store(R_y, of[i][1]), store(R_z, of[i][2]), store(p, of[i][3]);
  }
  for (int i = joints; i < N; ++i) {
    for (auto& vector : of[i]) store(Row<4>{}, vector);
  }
  return {by_components<N, 16>(of[0][0]), by_components<N, 16>(of[0][1]),
          by_components<N, 16>(of[0][2]), by_components<N, 16>(of[0][3])};
}

}  // namespace limber::dynamics::LIMBER_LEVEL
