// The equations of arm_kernel.h, a line each, over rows of joints.
#pragma once

#include <Eigen/Geometry>
#include <bit>

#include "dynamics/arm_kernel.h"
#include "dynamics/row_sines.h"

namespace limber::dynamics::LIMBER_LEVEL {

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

/// For arms of at most N joints.
template <int N>
class RowKernel final : public ArmKernel {
 public:
  RowKernel(const BodyChain& chain, const Eigen::Vector3d& gravity)
      : tip_(chain.frames.back()), size_(chain.size()), gravity_(gravity) {
    for (int i = 0; i < size_; ++i) {
      const Body& body = chain.bodies[static_cast<std::size_t>(i)];
      set_lane(body.prismatic ? &slides_ : &turns_, i, 1.0);
      set_lane(&joints_, i, std::bit_cast<double>(~std::uint64_t{0}));
      fixed_.set(i, body.R, body.p);
      RowKernel::set_mass(i, body.mass);
    }
  }

  std::unique_ptr<ArmKernel> copy() const override { return std::make_unique<RowKernel>(*this); }

  void set_mass(int body, const MassProperties& mass) noexcept override {
    const Eigen::Matrix3d& I = mass.inertia;
    set_lane(&m_, body, mass.mass);
    com_.set(body, mass.com);
    set_lane(&I_C_.xx, body, I(0, 0)), set_lane(&I_C_.xy, body, I(0, 1));
    set_lane(&I_C_.yy, body, I(1, 1)), set_lane(&I_C_.xz, body, I(0, 2));
    set_lane(&I_C_.zz, body, I(2, 2)), set_lane(&I_C_.yz, body, I(1, 2));
    carried_m_ = from_tip(m_);
  }

  LIMBER_TARGET void place(const VectorJ& q) noexcept override {
    const Row<N> position = padded(q);
    const RowSines<N> turn = sines(turns_ * position);
    X_ = from_base(RowPose<N>{turn.cosine * fixed_.R_x + turn.sine * fixed_.R_y,
                              turn.cosine * fixed_.R_y - turn.sine * fixed_.R_x, fixed_.R_z,
                              fixed_.p + slides_ * position * fixed_.R_z},
                   size_);
    S_ = {slides_ * X_.R_z + turns_ * cross(X_.p, X_.R_z), turns_ * X_.R_z};
    c_ = X_.p + rotated(X_, com_);
    h_ = m_ * c_;
    carried_h_ = from_tip(h_);
    place_tip();
  }
  Eigen::Matrix3d rotation(int body) const noexcept override {
    Eigen::Matrix3d R;
    R << X_.R_x.at(body), X_.R_y.at(body), X_.R_z.at(body);
    return R;
  }
  Eigen::Vector3d position(int body) const noexcept override { return X_.p.at(body); }
  Eigen::Vector3d centre_of_mass(int body) const noexcept override { return c_.at(body); }
  Eigen::Vector3d axis(int body) const noexcept override { return X_.R_z.at(body); }

  void jacobian(Matrix6J* J) const noexcept override {
    for (int i = 0; i < size_; ++i) {
      const Eigen::Vector3d w = S_.ang.at(i);
      J->col(i) << S_.lin.at(i) + w.cross(p_tip_), w;
    }
  }
  void add_wrench(int body, const Vector6& F, VectorJ* tau) const noexcept override {
    for (int i = 0; i <= body; ++i)
      (*tau)[i] += F.head<3>().dot(S_.lin.at(i)) + F.tail<3>().dot(S_.ang.at(i));
  }

  double potential_energy() const noexcept override { return -gravity_.dot(carried_h_.at(0)); }
  LIMBER_TARGET void gravity(VectorJ* g, VectorJ* slope) const noexcept override {
    const Row3<N> l = linear_momentum();
    store(-gravity_.x() * l.x - gravity_.y() * l.y - gravity_.z() * l.z, g->data());
    if (!slope) return;
    const Row3<N>& w = S_.ang;
    store((gravity_.z() * w.y - gravity_.y() * w.z) * l.x +
              (gravity_.x() * w.z - gravity_.z() * w.x) * l.y +
              (gravity_.y() * w.x - gravity_.x() * w.y) * l.z,
          slope->data());
  }
  void gravity_gradient(MatrixJ* slope) const noexcept override {
    const Row3<N> l = linear_momentum();
    for (int j = 0; j < size_; ++j) {
      const Eigen::Vector3d turned = S_.ang.at(j).cross(gravity_);
      for (int i = j; i < size_; ++i) (*slope)(i, j) = (*slope)(j, i) = turned.dot(l.at(i));
    }
  }

  // I_O = R I_C R^T + m (c.c 1 - c c^T).
  LIMBER_TARGET void weigh() noexcept override {
    const Row3<N> a = rotated(X_, Row3<N>{I_C_.xx, I_C_.xy, I_C_.xz});
    const Row3<N> b = rotated(X_, Row3<N>{I_C_.xy, I_C_.yy, I_C_.yz});
    const Row3<N> c = rotated(X_, Row3<N>{I_C_.xz, I_C_.yz, I_C_.zz});
    const auto entry = [&](Row<N> Row3<N>::*i, Row<N> Row3<N>::*k) __attribute__((always_inline))
                           ->Row<N> {
      return a.*i * X_.R_x.*k + b.*i * X_.R_y.*k + c.*i * X_.R_z.*k - h_.*i * c_.*k;
    };
    constexpr auto x = &Row3<N>::x, y = &Row3<N>::y, z = &Row3<N>::z;
    const Row<N> hc = dot(h_, c_);
    I_O_ = {entry(x, x) + hc, entry(y, y) + hc, entry(z, z) + hc,
            entry(x, y),      entry(x, z),      entry(y, z)};
  }
  LIMBER_TARGET void mass(MatrixJ* M) const noexcept override {
    const Row6<N> P = momentum_of(carried_m_, carried_h_, from_tip(I_O_), S_);
    double* const column = M->data();
    for (int j = 0; j < size_; ++j) {
      // Beyond the entry j it is overwritten by the next column, or has room behind the last.
      const Row<N> upper = lane(P.lin.x, j) * S_.lin.x + lane(P.lin.y, j) * S_.lin.y +
                           lane(P.lin.z, j) * S_.lin.z + lane(P.ang.x, j) * S_.ang.x +
                           lane(P.ang.y, j) * S_.ang.y + lane(P.ang.z, j) * S_.ang.z;
      store(upper, column + j * size_);
    }
    for (int j = 1; j < size_; ++j) {
      for (int i = 0; i < j; ++i) column[i * size_ + j] = column[j * size_ + i];
    }
  }

  LIMBER_TARGET void move(const VectorJ& v, const VectorJ& a) noexcept override {
    const Row<N> rate = padded(v);
    V_ = from_base(rate * S_);
    V_x_S_ = turn_twist(V_, S_);
    A_ = from_base(rate * V_x_S_ + padded(a) * S_);
  }
  Vector6 twist(int body) const noexcept override {
    Vector6 V;
    V << V_.lin.at(body), V_.ang.at(body);
    return V;
  }
  Vector6 tip_twist() const noexcept override {
    const Eigen::Vector3d w = V_.ang.at(size_ - 1);
    Vector6 V;
    V << V_.lin.at(size_ - 1) + w.cross(p_tip_), w;
    return V;
  }
  // Of the tip itself, not of the point fixed to the last body that passes the base origin.
  Vector6 tip_acceleration(const Vector6& V_BT) const noexcept override {
    const Eigen::Vector3d alpha = A_.ang.at(size_ - 1);
    Vector6 result;
    result << A_.lin.at(size_ - 1) + alpha.cross(p_tip_) + V_BT.tail<3>().cross(V_BT.head<3>()),
        alpha;
    return result;
  }
  LIMBER_TARGET void torque(VectorJ* tau, VectorJ* CTv) const noexcept override {
    const Row6<N> H = momentum_of(m_, h_, I_O_, V_);
    const Row6<N> F = momentum_of(m_, h_, I_O_, A_) + turn_momentum(V_, H);
    store(dot(S_, from_tip(F)), tau->data());
    if (CTv != nullptr) store(dot(V_x_S_, from_tip(H)), CTv->data());
  }

 private:
  /// What x has room for but no entry counts for nothing.
  [[gnu::always_inline]] inline Row<N> padded(const VectorJ& x) const noexcept {
    return loaded<N>(x.data()) & joints_;
  }
  void place_tip() noexcept {
    const Eigen::Matrix3d R = RowKernel::rotation(size_ - 1);
    R_tip_.noalias() = R * tip_.R;
    p_tip_ = RowKernel::position(size_ - 1) + R * tip_.p;
  }
  [[gnu::always_inline]] inline Row3<N> linear_momentum() const noexcept {
    return carried_m_ * S_.lin + cross(S_.ang, carried_h_);
  }

  // Of the chain.
  FixedFrame tip_;
  int size_;
  Eigen::Vector3d gravity_;
  Row<N> joints_{};            // all bits set for a joint
  Row<N> m_{}, carried_m_{};   // of the body; of all bodies that its joint carries
  Row<N> turns_{}, slides_{};  // 1 for a joint of the kind, else 0
  RowPose<N> fixed_{};         // in the body before, at joint position zero
  Row3<N> com_{};              // in body axes
  RowSymmetric<N> I_C_{};      // about the centre of mass, body axes
  // Of the present state.
  RowPose<N> X_{};
  Row6<N> S_{};
  Row3<N> c_{}, h_{}, carried_h_{};
  RowSymmetric<N> I_O_{};
  Row6<N> V_{}, V_x_S_{}, A_{};
};

}  // namespace limber::dynamics::LIMBER_LEVEL
