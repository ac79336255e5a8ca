#include "controller/observers/tip_force.h"

#include <Eigen/Geometry>

namespace limber::controller {

TipForce::TipForce(const Robot& robot)
    : gravity_(robot.gravity),
      p_TS_(robot.tip_sensor.p_TS),
      Q_TS_(robot.tip_sensor.quat_TS[0], robot.tip_sensor.quat_TS[1], robot.tip_sensor.quat_TS[2],
            robot.tip_sensor.quat_TS[3]),
      tool_mass_(robot.tip_sensor.tool_mass_kg),
      p_SC_(robot.tip_sensor.p_SC),
      bias_(robot.tip_sensor.bias.data()) {}

Vector6 TipForce::tool_wrench(const ArmTerms& terms, const Vector6& A_BT) const noexcept {
  const Eigen::Vector3d r_SC = R_BS_ * p_SC_;
  const Eigen::Vector3d r_TC = r_TS_ + r_SC;
  const Eigen::Vector3d omega = terms.V_BT.tail<3>();
  const Eigen::Vector3d a_C =
      A_BT.head<3>() + A_BT.tail<3>().cross(r_TC) + omega.cross(omega.cross(r_TC));
  const Eigen::Vector3d w = tool_mass_ * (gravity_ - a_C);
  Vector6 at_sensor;
  at_sensor << w, r_SC.cross(w);
  return at_sensor;
}

void TipForce::update(const TipReading& reading, const ArmTerms& terms,
                      const Vector6& A_BT) noexcept {
  const Eigen::Matrix3d R_BT = terms.X_BT.Q.toRotationMatrix();
  R_BS_ = R_BT * Q_TS_;
  r_TS_ = R_BT * p_TS_;
  const Vector6 F_S = reading.F - bias_;
  Vector6 at_sensor;
  at_sensor << R_BS_ * F_S.head<3>(), R_BS_ * F_S.tail<3>();
  at_sensor -= tool_wrench(terms, A_BT);
  const Eigen::Vector3d f = at_sensor.head<3>();
  F_ext_ << f, at_sensor.tail<3>() + r_TS_.cross(f);
  age_cycles_ = reading.age_cycles;
  valid_ = reading.usable && F_ext_.allFinite();
  if (!valid_) F_ext_.setZero();
}

bool TipForce::tare() noexcept {
  if (!valid_) return false;
  const Eigen::Vector3d f = F_ext_.head<3>();
  const Eigen::Vector3d mu = F_ext_.tail<3>() - r_TS_.cross(f);
  bias_.head<3>() += R_BS_.transpose() * f;
  bias_.tail<3>() += R_BS_.transpose() * mu;
  F_ext_.setZero();
  return true;
}

}  // namespace limber::controller
