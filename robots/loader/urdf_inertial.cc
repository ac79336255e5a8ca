#include "robots/loader/urdf_inertial.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <optional>

#include "robots/loader/urdf_rules.h"

namespace limber {
namespace {

constexpr double kHeavy_kg = 1'000.0;
constexpr double kLargestMass_kg = 10'000.0;
constexpr double kSlightlyNegative = 0.1;  ///< of the largest moment: rounding, a vendor's fit
constexpr double kRounding = 1e-9;
constexpr double kNothing_kgm2 = 1e-15;  ///< exporters' zeros

std::optional<double> read_mass(const XmlElement& mass, const std::string& where,
                                const InertialFindings& findings) {
  const auto value = attribute_numbers(mass, "value");
  if (value.size() != 1) return std::nullopt;
  const int line = mass.line;
  if (!(value[0] >= 0.0 && value[0] <= kLargestMass_kg)) {
    findings.refused->add(
        line, where,
        fmt::format("<mass> value: {} kg; allowed: 0 to {} kg", value[0], kLargestMass_kg));
  } else if (value[0] > kHeavy_kg) {
    findings.told->add(line, where, fmt::format("mass {} kg; are these grams?", value[0]));
  }
  return value[0];
}

std::optional<Eigen::Matrix3d> read_tensor(const XmlElement& inertia) {
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

void check_tensor(const Eigen::Matrix3d& tensor, int line, const std::string& link,
                  const InertialFindings& findings) {
  const std::string where = fmt::format("link '{}'", link);
  const Eigen::Vector3d moment =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor, Eigen::EigenvaluesOnly).eigenvalues();
  const std::string moments = fmt::format("principal moments {:.6g}, {:.6g}, {:.6g} kg m^2",
                                          moment[0], moment[1], moment[2]);
  if (!(moment[0] >= -kSlightlyNegative * moment[2])) {
    findings.refused->add(line, where,
                          fmt::format("<inertia>: not positive definite ({})", moments));
    return;
  }
  const bool negative = !(moment[0] >= -kRounding * moment[2]);
  if (!negative && moment[2] <= (moment[0] + moment[1]) * (1.0 + kRounding)) return;
  findings.told->add(line, where,
                     fmt::format("<inertia>: no body has it: {} ({}){}",
                                 negative ? "one principal moment is below zero"
                                          : "one principal moment exceeds the sum of the others",
                                 moments, findings.consequence));
  findings.unphysical->push_back({link, line, moment[0]});
}

}  // namespace

void check_urdf_inertial(const XmlElement& inertial, const std::string& link,
                         const InertialFindings& findings) {
  const std::string where = fmt::format("link '{}'", link);
  const XmlElement* mass = inertial.child("mass");
  const XmlElement* inertia = inertial.child("inertia");
  for (const auto& [element, name] : {std::pair{mass, "mass"}, std::pair{inertia, "inertia"}}) {
    if (element != nullptr) continue;
    findings.refused->add(inertial.line, where,
                          fmt::format("<inertial> without <{}>; leave <inertial> out altogether "
                                      "for a link without mass",
                                      name));
  }
  if (mass == nullptr || inertia == nullptr) return;
  const auto value = read_mass(*mass, where, findings);
  const auto tensor = read_tensor(*inertia);
  if (!value || !tensor) return;
  const bool no_inertia = tensor->cwiseAbs().maxCoeff() < kNothing_kgm2;
  if (no_inertia && *value > 0.0) {
    findings.told->add(inertia->line, where,
                       fmt::format("mass {} kg without inertia: a point mass", *value));
  } else if (!no_inertia && *value == 0.0) {
    findings.told->add(mass->line, where, "inertia without mass" + findings.consequence);
  }
  if (!no_inertia) check_tensor(*tensor, inertia->line, link, findings);
}

}  // namespace limber
