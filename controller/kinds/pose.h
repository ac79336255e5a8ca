// Position and orientation of one frame in another.
#pragma once

#include <Eigen/Geometry>

#pragma GCC visibility push(default)
namespace limber::controller {

/// X_BF: origin p of frame F in B, m, and the unit quaternion Q that turns F's axes into B's.
struct Pose {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond Q = Eigen::Quaterniond::Identity();
};

}  // namespace limber::controller
#pragma GCC visibility pop
