// What lies between the motors of a joint and its link: nothing, a spring with a damper, or one of
// them for each of two motors that pull against each other.
//
//   stretch      d = theta - side q            side: +1, the antagonist's -1
//   transmitted  T = f(s) + D s',  s: d beyond the backlash
//   link feels   side T,  motor feels -T
//
// So an elastic joint has tau_t = f(theta - q) + D (theta' - q') (Spong, "Modeling and control of
// elastic joint robots", ASME J. Dyn. Syst. 109, 1987), an antagonistic one f(theta_1 - q) -
// f(theta_2 + q), each tendon with a damper of its own.
#pragma once

#include "robots/loader/joint_chain.h"
#include "sim/joints/spring.h"

namespace limber::sim {

/// A value; every member but deflection() is allowed in the cycle. rad, N m. In the backlash and
/// along a slack tendon nothing is transmitted; behind backlash and in a tendon the damper pulls no
/// harder than the spring pushes.
class Transmission {
 public:
  Transmission() = default;  ///< rigid
  explicit Transmission(const TransmissionConfig& config);

  bool rigid() const noexcept { return kind_ == TransmissionKind::kRigid; }
  static constexpr double side(int motor) noexcept { return motor == 0 ? 1.0 : -1.0; }

  double torque(double stretch, double rate) const noexcept;  ///< T
  double spring_torque(double stretch) const noexcept { return spring_.torque(beyond(stretch)); }
  double energy(double stretch) const noexcept { return spring_.energy(beyond(stretch)); }
  double stiffness(double stretch) const noexcept;
  double damping(double stretch) const noexcept { return engaged(stretch) ? damping_ : 0.0; }
  /// No less than the stiffness anywhere within +-reach.
  double greatest_stiffness(double reach) const noexcept { return spring_.stiffness(reach); }
  double greatest_damping() const noexcept { return damping_; }
  bool damped() const noexcept { return !rigid() && damping_ > 0.0; }

  /// How far the equilibrium (theta, or (theta_1 - theta_2) / 2) must lie ahead of the link to give
  /// it `torque` at rest, with preload (theta_1 + theta_2) / 2. Set-up only.
  double deflection(double torque, double preload) const;

 private:
  bool one_sided() const noexcept { return spring_.pull_only() || half_backlash_ > 0.0; }
  bool engaged(double stretch) const noexcept;
  double beyond(double stretch) const noexcept;
  double torque_at_rest(double ahead, double preload) const noexcept;

  TransmissionKind kind_ = TransmissionKind::kRigid;
  Spring spring_;
  double damping_ = 0.0;
  double half_backlash_ = 0.0;
};

}  // namespace limber::sim
