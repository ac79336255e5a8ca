// The peer of the arm's terms: the same cycle by Pinocchio, which only the benchmarks know.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "common/types.h"
#include "dynamics/body_chain.h"

namespace limber::bench {

/// Arms of any number of joints. Pinocchio's least work that we know of for pose, J, Jdot v, M and
/// C v + g: crba() in world axes, whose J comes with it, and nonLinearEffects(), whose
/// accelerations give Jdot v. Joints about or along z, which are its fastest.
class PinocchioPeer {
 public:
  PinocchioPeer(const dynamics::BodyChain& chain, const Eigen::Vector3d& gravity);
  ~PinocchioPeer();

  void evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v);

  Eigen::Vector3d p;
  Eigen::Matrix3d R;
  Eigen::Matrix<double, 6, Eigen::Dynamic> J;  ///< base axes, at the tip, linear part first
  Vector6 Jdot_v;
  const Eigen::MatrixXd& M() const;  ///< upper triangle
  const Eigen::VectorXd& nle() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
  Eigen::Matrix3d R_tip_;
  Eigen::Vector3d p_tip_;
  Eigen::Vector3d gravity_;
};

}  // namespace limber::bench
