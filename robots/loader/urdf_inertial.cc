#include "robots/loader/urdf_inertial.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <optional>

#include "robots/loader/urdf_rules.h"

namespace limber {
namespace {

using tinyxml2::XMLElement;

constexpr double kLargestMass_kg = 1000.0;

void check_mass(const XMLElement& mass, const std::string& where, Complaints* complaints) {
  const auto value = attribute_numbers(mass, "value");
  if (value.size() != 1 || (value[0] > 0.0 && value[0] <= kLargestMass_kg)) return;
  complaints->add(mass.GetLineNum(), where,
                  fmt::format("<mass> value: {} kg; allowed: above 0, up to {} (leave <inertial> "
                              "out for a link without mass)",
                              value[0], kLargestMass_kg));
}

std::optional<Eigen::Matrix3d> read_tensor(const XMLElement& inertia) {
  const char* const names[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
  const int rows[] = {0, 0, 0, 1, 1, 2};
  const int columns[] = {0, 1, 2, 1, 2, 2};
  Eigen::Matrix3d tensor;
  for (int i = 0; i < 6; ++i) {
    const auto value = attribute_numbers(inertia, names[i]);
    if (value.size() != 1) return std::nullopt;
    tensor(rows[i], columns[i]) = tensor(columns[i], rows[i]) = value[0];
  }
  return tensor;
}

void check_inertia(const XMLElement& inertia, const std::string& where, Complaints* complaints) {
  const auto tensor = read_tensor(inertia);
  if (!tensor) return;
  const Eigen::Vector3d moment =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(*tensor, Eigen::EigenvaluesOnly).eigenvalues();
  const std::string moments = fmt::format("principal moments {:.6g}, {:.6g}, {:.6g} kg m^2",
                                          moment[0], moment[1], moment[2]);
  if (!(moment[0] > 0.0)) {
    complaints->add(inertia.GetLineNum(), where,
                    fmt::format("<inertia>: not positive definite ({})", moments));
  } else if (!(moment[2] <= (moment[0] + moment[1]) * (1.0 + 1e-9))) {
    complaints->add(inertia.GetLineNum(), where,
                    fmt::format("<inertia>: no body has it: one principal moment exceeds the sum "
                                "of the other two ({})",
                                moments));
  }
}

// Exporters write the links that are mere frames so.
bool is_nothing(const XMLElement& mass, const XMLElement& inertia) {
  const auto value = attribute_numbers(mass, "value");
  const auto tensor = read_tensor(inertia);
  return value.size() == 1 && value[0] == 0.0 && tensor && tensor->isZero(0.0);
}

}  // namespace

void check_urdf_inertial(const XMLElement& inertial, const std::string& where,
                         Complaints* complaints) {
  const XMLElement* mass = inertial.FirstChildElement("mass");
  const XMLElement* inertia = inertial.FirstChildElement("inertia");
  for (const auto& [element, name] : {std::pair{mass, "mass"}, std::pair{inertia, "inertia"}}) {
    if (element != nullptr) continue;
    complaints->add(inertial.GetLineNum(), where,
                    fmt::format("<inertial> without <{}>; leave <inertial> out altogether for a "
                                "link without mass",
                                name));
  }
  if (mass != nullptr && inertia != nullptr && is_nothing(*mass, *inertia)) return;
  if (mass != nullptr) check_mass(*mass, where, complaints);
  if (inertia != nullptr) check_inertia(*inertia, where, complaints);
}

}  // namespace limber
