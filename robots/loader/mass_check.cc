#include "robots/loader/mass_check.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <kdl/chaindynparam.hpp>

#include "common/config_error.h"
#include "robots/loader/sample_pose.h"

namespace limber {
namespace {

constexpr unsigned kPoses = 8;
/// Of the mass matrix scaled to a unit diagonal.
constexpr double kSmallestEigenvalue = 1e-10;
constexpr double kSmallestDiagonal = 1e-12;  // kg m^2

void check_at(const LoadedRobot& robot, const std::vector<double>& pose, const std::string& file) {
  const int n = robot.robot.size();
  KDL::JntArray q(static_cast<unsigned>(n));
  for (int i = 0; i < n; ++i) q(static_cast<unsigned>(i)) = pose[static_cast<std::size_t>(i)];
  KDL::JntSpaceInertiaMatrix mass(static_cast<unsigned>(n));
  KDL::ChainDynParam(robot.chain, KDL::Vector::Zero()).JntToMass(q, mass);
  const Eigen::VectorXd diagonal = mass.data.diagonal();
  auto refuse = [&](Eigen::Index joint) {
    throw ConfigError::at(
        file, 0,
        fmt::format("joint '{}'", robot.robot.joints[static_cast<std::size_t>(joint)].name),
        "moves no mass: the mass matrix is not positive definite; give the links behind it an "
        "<inertial>");
  };
  for (int i = 0; i < n; ++i) {
    if (!(diagonal[i] > kSmallestDiagonal)) refuse(i);
  }
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * mass.data * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  if (solver.eigenvalues()[0] > kSmallestEigenvalue) return;
  Eigen::Index joint = 0;
  solver.eigenvectors().col(0).cwiseAbs().maxCoeff(&joint);
  refuse(joint);
}

}  // namespace

void check_mass_matrix(const LoadedRobot& robot, const std::string& file) {
  std::vector<double> home;
  for (const JointConfig& joint : robot.robot.joints) home.push_back(joint.home);
  check_at(robot, home, file);
  for (unsigned i = 0; i < kPoses; ++i) check_at(robot, sample_pose(robot.robot, i), file);
}

}  // namespace limber
