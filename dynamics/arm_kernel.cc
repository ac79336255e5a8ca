#include "dynamics/arm_kernel.h"

#include <Eigen/Geometry>
#include <cstring>

#include "dynamics/each_processor.h"
#include "dynamics/row_sines.h"

namespace limber::dynamics {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

template <int N>
[[gnu::always_inline]] inline Row6<N> turn_twist(const Row6<N>& V, const Row6<N>& S) noexcept {
  return {cross(V.ang, S.lin) + cross(V.lin, S.ang), cross(V.ang, S.ang)};
}

template <int N>
[[gnu::always_inline]] inline Row6<N> turn_momentum(const Row6<N>& V, const Row6<N>& H) noexcept {
  return {cross(V.ang, H.lin), cross(V.ang, H.ang) + cross(V.lin, H.lin)};
}

template <int N>
[[gnu::always_inline]] inline Row6<N> momentum_of(const Row<N>& m, const Row3<N>& h,
                                                  const RowSymmetric<N>& I_O,
                                                  const Row6<N>& V) noexcept {
  return {m * V.lin + cross(V.ang, h), I_O * V.ang + cross(h, V.lin)};
}

// What x has room for but no entry counts for nothing.
template <int N>
[[gnu::always_inline]] inline Row<N> padded(const VectorJ& x) noexcept {
  Row<N> row, lane;
  for (int i = 0; i < N; ++i) lane[i] = i;
  std::memcpy(&row, x.data(), sizeof row);
  return lane < static_cast<double>(x.size()) ? row : Row<N>{};
}

}  // namespace

template <int N>
ArmKernel<N>::ArmKernel(const BodyChain& chain, const Vector3d& gravity)
    : chain_(chain), size_(chain.size()), gravity_(gravity) {
  const Row<N> zero = Row<N>{};
  m_ = zero;
  com_ = c_ = h_ = {zero, zero, zero};
  fixed_ = X_ = {c_, c_, c_, c_};
  S_ = V_ = V_x_S_ = A_ = {c_, c_};
  I_C_ = I_O_ = {zero, zero, zero, zero, zero, zero};
  turns_ = slides_ = zero;
  for (int i = 0; i < size_; ++i) {
    const Body& body = chain.bodies[static_cast<std::size_t>(i)];
    (body.prismatic ? slides_ : turns_)[i] = 1.0;
    fixed_.set(i, body.R, body.p);
    set_mass(i, body.mass);
  }
}

template <int N>
void ArmKernel<N>::set_mass(int body, const MassProperties& mass) noexcept {
  const Matrix3d& I = mass.inertia;
  m_[body] = mass.mass;
  com_.set(body, mass.com);
  I_C_.xx[body] = I(0, 0), I_C_.yy[body] = I(1, 1), I_C_.zz[body] = I(2, 2);
  I_C_.xy[body] = I(0, 1), I_C_.xz[body] = I(0, 2), I_C_.yz[body] = I(1, 2);
  carried_m_ = from_tip<N>(m_);
}

template <int N>
[[gnu::always_inline]] inline void ArmKernel<N>::place_rows(const VectorJ& q) noexcept {
  const Row<N> position = padded<N>(q);
  const RowSines<N> turn = sines<N>(turns_ * position);
  RowPose<N> X = fixed_;
  X.p = X.p + slides_ * position * X.R_z;
  X.R_x = turn.cosine * fixed_.R_x + turn.sine * fixed_.R_y;
  X.R_y = turn.cosine * fixed_.R_y - turn.sine * fixed_.R_x;
  X_ = from_base<N>(X, size_);
}

template <int N>
void ArmKernel<N>::place_tip() noexcept {
  const FixedFrame& tip = chain_.frames.back();
  const Matrix3d R = rotation(size_ - 1);
  R_tip_ = R * tip.R;
  p_tip_ = position(size_ - 1) + R * tip.p;
}

template <int N>
[[gnu::always_inline]] inline void ArmKernel<N>::spread_rows() noexcept {
  const Row3<N> moment = cross(X_.p, X_.R_z);
  S_ = {slides_ * X_.R_z + turns_ * moment, turns_ * X_.R_z};
  c_ = X_.p + rotated(X_, com_);
  h_ = m_ * c_;
  carried_h_ = from_tip<N>(h_);
}

template <int N>
Matrix3d ArmKernel<N>::rotation(int body) const noexcept {
  Matrix3d R;
  R << X_.R_x.at(body), X_.R_y.at(body), X_.R_z.at(body);
  return R;
}

// I_O = R I_C R^T + m (c.c 1 - c c^T).
template <int N>
[[gnu::always_inline]] inline void ArmKernel<N>::weigh_rows() noexcept {
  const Row3<N> a = rotated<N>(X_, {I_C_.xx, I_C_.xy, I_C_.xz});
  const Row3<N> b = rotated<N>(X_, {I_C_.xy, I_C_.yy, I_C_.yz});
  const Row3<N> c = rotated<N>(X_, {I_C_.xz, I_C_.yz, I_C_.zz});
  const auto entry = [&](const auto& i, const auto& k) -> Row<N> {
    return i(a) * k(X_.R_x) + i(b) * k(X_.R_y) + i(c) * k(X_.R_z) - i(h_) * k(c_);
  };
  const auto x = [](const Row3<N>& v) -> const Row<N>& { return v.x; };
  const auto y = [](const Row3<N>& v) -> const Row<N>& { return v.y; };
  const auto z = [](const Row3<N>& v) -> const Row<N>& { return v.z; };
  const Row<N> hc = dot(h_, c_);
  I_O_ = {entry(x, x) + hc, entry(y, y) + hc, entry(z, z) + hc,
          entry(x, y),      entry(x, z),      entry(y, z)};
}

template <int N>
[[gnu::always_inline]] inline void ArmKernel<N>::move_rows(const VectorJ& v,
                                                           const VectorJ& a) noexcept {
  const Row<N> rate = padded<N>(v);
  V_ = from_base<N>(rate * S_);
  V_x_S_ = turn_twist(V_, S_);
  A_ = from_base<N>(rate * V_x_S_ + padded<N>(a) * S_);
}

template <int N>
void ArmKernel<N>::jacobian(Matrix6J* J) const noexcept {
  for (int i = 0; i < size_; ++i) {
    const Vector3d w = S_.ang.at(i);
    J->col(i) << S_.lin.at(i) + w.cross(p_tip_), w;
  }
}

template <int N>
void ArmKernel<N>::add_wrench(int body, const Vector6& F, VectorJ* tau) const noexcept {
  const Row<N> torque = F[0] * S_.lin.x + F[1] * S_.lin.y + F[2] * S_.lin.z + F[3] * S_.ang.x +
                        F[4] * S_.ang.y + F[5] * S_.ang.z;
  for (int i = 0; i <= body; ++i) (*tau)[i] += torque[i];
}

template <int N>
double ArmKernel<N>::potential_energy() const noexcept {
  return -gravity_.dot(carried_h_.at(0));
}

template <int N>
Vector6 ArmKernel<N>::twist(int body) const noexcept {
  Vector6 V;
  V << V_.lin.at(body), V_.ang.at(body);
  return V;
}

template <int N>
Vector6 ArmKernel<N>::tip_twist() const noexcept {
  const Vector3d w = V_.ang.at(size_ - 1);
  Vector6 V;
  V << V_.lin.at(size_ - 1) + w.cross(p_tip_), w;
  return V;
}

// Of the tip itself, not of the point fixed to the last body that passes the base origin.
template <int N>
Vector6 ArmKernel<N>::tip_acceleration(const Vector6& V_BT) const noexcept {
  const Vector3d alpha = A_.ang.at(size_ - 1);
  Vector6 result;
  result << A_.lin.at(size_ - 1) + alpha.cross(p_tip_) + V_BT.tail<3>().cross(V_BT.head<3>()),
      alpha;
  return result;
}

template <int N>
[[gnu::always_inline]] inline Row3<N> ArmKernel<N>::linear_momentum() const noexcept {
  return carried_m_ * S_.lin + cross(S_.ang, carried_h_);
}

template <int N>
[[gnu::always_inline]] inline void ArmKernel<N>::gravity_rows(VectorJ* g) const noexcept {
  const Row3<N> l = linear_momentum();
  const Row<N> torque = gravity_.x() * l.x + gravity_.y() * l.y + gravity_.z() * l.z;
  for (int i = 0; i < size_; ++i) (*g)[i] = -torque[i];
}

template <int N>
void ArmKernel<N>::gravity_gradient(MatrixJ* slope) const noexcept {
  const Row3<N> l = linear_momentum();
  for (int j = 0; j < size_; ++j) {
    const Vector3d turned = S_.ang.at(j).cross(gravity_);
    for (int i = j; i < size_; ++i) (*slope)(i, j) = (*slope)(j, i) = turned.dot(l.at(i));
  }
}

template <int N>
void ArmKernel<N>::gravity_slope(VectorJ* slope) const noexcept {
  const Row3<N> l = linear_momentum();
  for (int i = 0; i < size_; ++i) (*slope)[i] = S_.ang.at(i).cross(gravity_).dot(l.at(i));
}

template <int N>
[[gnu::always_inline]] inline void ArmKernel<N>::mass_rows(MatrixJ* M) const noexcept {
  const Row6<N> P = momentum_of<N>(carried_m_, carried_h_, from_tip<N>(I_O_), S_);
  for (int j = 0; j < size_; ++j) {
    const Row<N> column = P.lin.x[j] * S_.lin.x + P.lin.y[j] * S_.lin.y + P.lin.z[j] * S_.lin.z +
                          P.ang.x[j] * S_.ang.x + P.ang.y[j] * S_.ang.y + P.ang.z[j] * S_.ang.z;
    for (int i = 0; i <= j; ++i) (*M)(i, j) = (*M)(j, i) = column[i];
  }
}

template <int N>
[[gnu::always_inline]] inline void ArmKernel<N>::torque_rows(VectorJ* tau,
                                                             VectorJ* CTv) const noexcept {
  const Row6<N> H = momentum_of<N>(m_, h_, I_O_, V_);
  const Row6<N> F = momentum_of<N>(m_, h_, I_O_, A_) + turn_momentum(V_, H);
  const Row<N> Ma_Cv = dot(S_, from_tip<N>(F));
  for (int i = 0; i < size_; ++i) (*tau)[i] = Ma_Cv[i];
  if (CTv == nullptr) return;
  const Row<N> C_transposed_v = dot(V_x_S_, from_tip<N>(H));
  for (int i = 0; i < size_; ++i) (*CTv)[i] = C_transposed_v[i];
}

#define LIMBER_ROWS_OF(N)                                                                      \
  template <>                                                                                  \
  LIMBER_EACH_PROCESSOR void ArmKernel<N>::place(const VectorJ& q) noexcept {                  \
    place_rows(q);                                                                             \
    spread_rows();                                                                             \
    place_tip();                                                                               \
  }                                                                                            \
  template <>                                                                                  \
  LIMBER_EACH_PROCESSOR void ArmKernel<N>::weigh() noexcept {                                  \
    weigh_rows();                                                                              \
  }                                                                                            \
  template <>                                                                                  \
  LIMBER_EACH_PROCESSOR void ArmKernel<N>::move(const VectorJ& v, const VectorJ& a) noexcept { \
    move_rows(v, a);                                                                           \
  }                                                                                            \
  template <>                                                                                  \
  LIMBER_EACH_PROCESSOR void ArmKernel<N>::gravity(VectorJ* g) const noexcept {                \
    gravity_rows(g);                                                                           \
  }                                                                                            \
  template <>                                                                                  \
  LIMBER_EACH_PROCESSOR void ArmKernel<N>::mass(MatrixJ* M) const noexcept {                   \
    mass_rows(M);                                                                              \
  }                                                                                            \
  template <>                                                                                  \
  LIMBER_EACH_PROCESSOR void ArmKernel<N>::torque(VectorJ* tau, VectorJ* CTv) const noexcept { \
    torque_rows(tau, CTv);                                                                     \
  }
LIMBER_ROWS_OF(8)
LIMBER_ROWS_OF(16)
#undef LIMBER_ROWS_OF

template class ArmKernel<8>;
template class ArmKernel<16>;

AnyArmKernel arm_kernel(const BodyChain& chain, const Vector3d& gravity) {
  if (chain.size() <= 8) return ArmKernel<8>(chain, gravity);
  return ArmKernel<16>(chain, gravity);
}

}  // namespace limber::dynamics
