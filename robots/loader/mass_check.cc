#include "robots/loader/mass_check.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <kdl/chaindynparam.hpp>

#include "common/config_error.h"
#include "robots/loader/sample_pose.h"

namespace limber {
namespace {

constexpr unsigned kPoses = 8;
constexpr unsigned kManyPoses = 1000;
/// Of the mass matrix scaled to a unit diagonal.
constexpr double kSmallestEigenvalue = 1e-10;
constexpr double kSmallestDiagonal = 1e-12;  // kg m^2

Eigen::MatrixXd mass_matrix(const LoadedRobot& robot, const std::vector<double>& pose) {
  const auto n = static_cast<unsigned>(pose.size());
  KDL::JntArray q(n);
  for (unsigned i = 0; i < n; ++i) q(i) = pose[i];
  KDL::JntSpaceInertiaMatrix mass(n);
  KDL::ChainDynParam(robot.chain, KDL::Vector::Zero()).JntToMass(q, mass);
  return mass.data;
}

/// The joint that moves too little, or -1 if M is positive definite.
Eigen::Index weak_joint(const Eigen::MatrixXd& M) {
  const Eigen::VectorXd diagonal = M.diagonal();
  for (Eigen::Index i = 0; i < diagonal.size(); ++i) {
    if (!(diagonal[i] > kSmallestDiagonal)) return i;
  }
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * M * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  if (solver.eigenvalues()[0] > kSmallestEigenvalue) return -1;
  Eigen::Index joint = 0;
  solver.eigenvectors().col(0).cwiseAbs().maxCoeff(&joint);
  return joint;
}

std::string listed(const std::vector<double>& pose) {
  std::string text;
  for (const double angle : pose) text += fmt::format("{}{:.3f}", text.empty() ? "" : ", ", angle);
  return "[" + text + "]";
}

[[noreturn]] void refuse_inertia(const std::string& file, const UnphysicalLink& suspect,
                                 const Eigen::MatrixXd& M, const std::vector<double>& pose) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(M, Eigen::EigenvaluesOnly);
  throw ConfigError::at(
      file, suspect.line, fmt::format("link '{}'", suspect.link),
      fmt::format("<inertia>: a principal moment of {:.3g} kg m^2 makes the mass matrix not "
                  "positive definite: smallest eigenvalue {:.3g} at q = {}; correct this link's "
                  "inertia",
                  suspect.smallest_moment_kgm2, solver.eigenvalues()[0], listed(pose)));
}

void check_at(const LoadedRobot& robot, const std::vector<UnphysicalLink>& unphysical,
              const std::vector<double>& pose) {
  const Eigen::MatrixXd M = mass_matrix(robot, pose);
  const Eigen::Index joint = weak_joint(M);
  if (joint < 0) return;
  const std::string& file = robot.robot.urdf_path;
  const auto suspect = std::ranges::min_element(
      unphysical, {}, [](const UnphysicalLink& link) { return link.smallest_moment_kgm2; });
  if (suspect != unphysical.end() && suspect->smallest_moment_kgm2 < 0.0)
    refuse_inertia(file, *suspect, M, pose);
  throw ConfigError::at(
      file, 0, fmt::format("joint '{}'", robot.robot.joints[static_cast<std::size_t>(joint)].name),
      "moves no mass: the mass matrix is not positive definite; give the links behind it an "
      "<inertial>");
}

}  // namespace

void check_mass_matrix(const LoadedRobot& robot, const std::vector<UnphysicalLink>& unphysical) {
  std::vector<double> home;
  for (const JointConfig& joint : robot.robot.joints) home.push_back(joint.home);
  check_at(robot, unphysical, home);
  const unsigned poses = unphysical.empty() ? kPoses : kManyPoses;
  for (unsigned i = 0; i < poses; ++i) check_at(robot, unphysical, sample_pose(robot.robot, i));
}

}  // namespace limber
