// The links and joints of a URDF as the chain is built from them.
#pragma once

#include <urdf_model/model.h>

#include <string>

namespace limber {

/// {"joints": [...], "inertials": [...]}: poses of joint frames in their parent links and of
/// inertials in theirs, p_m and quat_xyzw; tensors about the centre of mass in the inertial's axes.
std::string tree_json(const urdf::ModelInterface& model);

}  // namespace limber
