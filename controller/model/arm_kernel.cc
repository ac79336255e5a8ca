#include "controller/model/arm_kernel.h"

#include <cmath>

namespace limber::controller {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

template <int N>
Row6<N> turn_twist(const Row6<N>& V, const Row6<N>& S) noexcept {
  return {cross(V.ang, S.lin) + cross(V.lin, S.ang), cross(V.ang, S.ang)};
}

template <int N>
Row6<N> turn_momentum(const Row6<N>& V, const Row6<N>& H) noexcept {
  return {cross(V.ang, H.lin), cross(V.ang, H.ang) + cross(V.lin, H.lin)};
}

template <int N>
Row6<N> momentum_of(const Row<N>& m, const Row3<N>& h, const RowSymmetric<N>& I_O,
                    const Row6<N>& V) noexcept {
  return {m * V.lin + cross(V.ang, h), I_O * V.ang + cross(h, V.lin)};
}

template <int N>
Row<N> padded(const VectorJ& x) noexcept {
  Row<N> row = Row<N>::Zero();
  for (Eigen::Index i = 0; i < x.size(); ++i) row[i] = x[i];
  return row;
}

}  // namespace

template <int N>
ArmKernel<N>::ArmKernel(const BodyChain& chain, const Vector3d& gravity)
    : chain_(chain), size_(static_cast<int>(chain.bodies.size())), gravity_(gravity) {
  const Row<N> zero = Row<N>::Zero();
  m_ = zero;
  com_ = R_x_ = R_y_ = R_z_ = p_ = c_ = h_ = {zero, zero, zero};
  S_ = V_ = V_x_S_ = A_ = {p_, p_};
  I_C_ = I_O_ = {zero, zero, zero, zero, zero, zero};
  for (int i = 0; i < size_; ++i) {
    const Body& body = chain.bodies[static_cast<std::size_t>(i)];
    m_[i] = body.mass;
    com_.set(i, body.com);
    const Matrix3d& I = body.inertia;
    I_C_.xx[i] = I(0, 0), I_C_.yy[i] = I(1, 1), I_C_.zz[i] = I(2, 2);
    I_C_.xy[i] = I(0, 1), I_C_.xz[i] = I(0, 2), I_C_.yz[i] = I(1, 2);
  }
}

template <int N>
void ArmKernel<N>::place(const VectorJ& q) noexcept {
  Matrix3d R = Matrix3d::Identity();
  Vector3d p = Vector3d::Zero();
  for (int i = 0; i < size_; ++i) {
    const Body& body = chain_.bodies[static_cast<std::size_t>(i)];
    p += R * body.p;
    R = R * body.R;
    const Vector3d x = R.col(0), y = R.col(1), z = R.col(2);
    if (body.prismatic) {
      p += q[i] * z;
      S_.lin.set(i, z);
    } else {
      const double cosine = std::cos(q[i]), sine = std::sin(q[i]);
      R.col(0) = cosine * x + sine * y;
      R.col(1) = cosine * y - sine * x;
      S_.lin.set(i, p.cross(z));
      S_.ang.set(i, z);
    }
    R_x_.set(i, R.col(0)), R_y_.set(i, R.col(1)), R_z_.set(i, R.col(2)), p_.set(i, p);
  }
  R_tip_ = R * chain_.R_tip;
  p_tip_ = p + R * chain_.p_tip;
  c_ = p_ + com_.x * R_x_ + com_.y * R_y_ + com_.z * R_z_;
  h_ = m_ * c_;
}

// I_O = R I_C R^T + m (c.c 1 - c c^T).
template <int N>
void ArmKernel<N>::weigh() noexcept {
  const Row3<N> a = I_C_.xx * R_x_ + I_C_.xy * R_y_ + I_C_.xz * R_z_;
  const Row3<N> b = I_C_.xy * R_x_ + I_C_.yy * R_y_ + I_C_.yz * R_z_;
  const Row3<N> c = I_C_.xz * R_x_ + I_C_.yz * R_y_ + I_C_.zz * R_z_;
  const auto entry = [&](const auto& i, const auto& k) -> Row<N> {
    return i(a) * k(R_x_) + i(b) * k(R_y_) + i(c) * k(R_z_) - i(h_) * k(c_);
  };
  const auto x = [](const Row3<N>& v) -> const Row<N>& { return v.x; };
  const auto y = [](const Row3<N>& v) -> const Row<N>& { return v.y; };
  const auto z = [](const Row3<N>& v) -> const Row<N>& { return v.z; };
  const Row<N> hc = dot(h_, c_);
  I_O_ = {entry(x, x) + hc, entry(y, y) + hc, entry(z, z) + hc,
          entry(x, y),      entry(x, z),      entry(y, z)};
}

template <int N>
void ArmKernel<N>::move(const VectorJ& v, const VectorJ& a) noexcept {
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
Row3<N> ArmKernel<N>::linear_momentum() const noexcept {
  return from_tip<N>(m_) * S_.lin + cross(S_.ang, from_tip<N>(h_));
}

template <int N>
void ArmKernel<N>::gravity(VectorJ* g) const noexcept {
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
void ArmKernel<N>::mass(MatrixJ* M) const noexcept {
  const Row6<N> P = momentum_of<N>(from_tip<N>(m_), from_tip<N>(h_), from_tip<N>(I_O_), S_);
  for (int j = 0; j < size_; ++j) {
    const Row<N> column = P.lin.x[j] * S_.lin.x + P.lin.y[j] * S_.lin.y + P.lin.z[j] * S_.lin.z +
                          P.ang.x[j] * S_.ang.x + P.ang.y[j] * S_.ang.y + P.ang.z[j] * S_.ang.z;
    for (int i = 0; i <= j; ++i) (*M)(i, j) = (*M)(j, i) = column[i];
  }
}

template <int N>
void ArmKernel<N>::torque(VectorJ* tau, VectorJ* CTv) const noexcept {
  const Row6<N> H = momentum_of<N>(m_, h_, I_O_, V_);
  const Row6<N> F = momentum_of<N>(m_, h_, I_O_, A_) + turn_momentum(V_, H);
  const Row<N> Ma_Cv = dot(S_, from_tip<N>(F));
  const Row<N> C_transposed_v = dot(V_x_S_, from_tip<N>(H));
  for (int i = 0; i < size_; ++i) (*tau)[i] = Ma_Cv[i], (*CTv)[i] = C_transposed_v[i];
}

template class ArmKernel<8>;
template class ArmKernel<16>;

}  // namespace limber::controller
