// Forward dynamics of a serial arm by the articulated-body algorithm, with rotors and wrenches on
// any link.
//
//   (M(q) + B) qdd + C(q,v) v + g(q) = tau + sum_i J_i^T F_i
//
// Source: R. Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 7; written with base axes
// throughout and each body's own joint origin as reference point. Deliberately shares nothing with
// the controller's terms (controller/model/arm_kernel.h), so that the one checks the other.
#pragma once

#include <Eigen/Core>
#include <array>

#include "common/types.h"
#include "sim/plant/arm_model.h"

namespace limber::sim {

/// Everything in base axes. No member but the constructor allocates; all may be called in the
/// cycle.
class ArticulatedBody {
 public:
  explicit ArticulatedBody(ArmModel model);

  int size() const noexcept { return model_.size(); }
  const ArmModel& model() const noexcept { return model_; }

  /// A point mass at p_TL in tip axes, kg and m; 0 removes it. Replaces an earlier one. Acts from
  /// the next set_state() on.
  void set_tip_load(double mass, const Eigen::Vector3d& p_TL) noexcept;

  /// Position and velocity of all bodies. Wrenches are cleared.
  void set_state(const VectorJ& q, const VectorJ& v) noexcept;

  void clear_wrenches() noexcept;
  /// The world pushes `body` with a force at `point` (base frame) and a moment. Body -1, the base,
  /// takes it in silence.
  void add_wrench(int body, const Eigen::Vector3d& point, const Eigen::Vector3d& force,
                  const Eigen::Vector3d& moment) noexcept;
  // Sum of the wrenches added to a body, reduced to its joint origin.
  Eigen::Vector3d external_force(int body) const noexcept { return state_[body].f_ext; }
  Eigen::Vector3d external_moment(int body) const noexcept { return state_[body].n_ext; }
  /// Joint torque of the wrenches added: sum J_i^T F_i.
  void wrench_torque(VectorJ* tau) const noexcept;

  /// Acceleration at the present state, with `extra_inertia` added to B (an implicit integrator's
  /// h*damping, or zero).
  void accelerations(const VectorJ& tau, const VectorJ& extra_inertia, VectorJ* qdd) noexcept;

  /// n^T J (M + B)^-1 J^T n for the tip origin and a unit vector n: how fast a newton along n
  /// accelerates the tip along n, 1/kg; 0 where the arm cannot move that way. Clears the wrenches.
  double tip_mobility(const Eigen::Vector3d& n) noexcept;

  /// Frames are indexed as in ArmModel::links.
  int tip() const noexcept { return static_cast<int>(model_.links.size()) - 1; }
  Eigen::Vector3d link_position(int link) const noexcept;
  Eigen::Matrix3d link_rotation(int link) const noexcept;
  Eigen::Vector3d link_velocity(int link) const noexcept;
  Eigen::Vector3d link_angular_velocity(int link) const noexcept;

  // Of the body frames (on the joint axes); body -1 is the base.
  Eigen::Vector3d body_position(int body) const noexcept;
  Eigen::Matrix3d body_rotation(int body) const noexcept;
  Eigen::Vector3d joint_axis(int body) const noexcept { return state_[body].z; }
  /// Velocity of the point of the body that is at `point` (base frame).
  Eigen::Vector3d point_velocity(int body, const Eigen::Vector3d& point) const noexcept;
  Eigen::Vector3d angular_velocity(int body) const noexcept;

  /// Of all links and rotors, J.
  double kinetic_energy() const noexcept;
  /// Of gravity, zero with every mass at the height of the base origin, J.
  double potential_energy() const noexcept;

 private:
  /// Base axes; vectors from the joint origin unless they are positions.
  struct BodyState {
    Eigen::Matrix3d R;      // body to base
    Eigen::Vector3d p;      // joint origin
    Eigen::Vector3d z;      // joint axis
    Eigen::Vector3d r;      // from the origin of the body before
    Eigen::Vector3d c;      // to the centre of mass
    Eigen::Matrix3d I;      // about the centre of mass
    Eigen::Vector3d v;      // of the joint origin
    Eigen::Vector3d w;      // angular velocity
    Eigen::Vector3d c_lin;  // velocity-product acceleration: linear and angular
    Eigen::Vector3d c_ang;
    Eigen::Vector3d f_bias;  // force and moment that the velocity alone needs
    Eigen::Vector3d n_bias;
    Eigen::Vector3d f_ext;  // wrench of the world
    Eigen::Vector3d n_ext;
  };
  /// Articulated inertia [A H; H^T J] and bias [f; n], then what the forward sweep needs of them.
  struct Articulated {
    Eigen::Matrix3d A, H, J;
    Eigen::Vector3d f, n;
    Eigen::Vector3d U_f, U_n;
    double d, u;
  };

  void place(int i, double q, double v) noexcept;
  void start(int i) noexcept;
  void reduce(int i, double tau, double extra_inertia) noexcept;
  void hand_down(int i) noexcept;

  ArmModel model_;
  MassProperties bare_tip_body_;
  VectorJ v_;
  std::array<BodyState, kMaxJoints> state_;
  std::array<Articulated, kMaxJoints> sweep_;
};

}  // namespace limber::sim
