#include "lecture/eval/law_table.h"

#include <array>
#include <vector>

#include "common/config_error.h"
#include "common/suggest.h"

// One line a law: those of an arm, and those without one.
// clang-format off
#define LIMBER_ARM_LAWS(LAW) \
  LAW(kin_dyn)               \
  LAW(pose_error)            \
  LAW(joint_pd)              \
  LAW(salisbury)             \
  LAW(cartesian_impedance)   \
  LAW(eq4)                   \
  LAW(eq7)                   \
  LAW(computed_torque)       \
  LAW(pd_plus)               \
  LAW(joint_impedance)       \
  LAW(opspace_impedance)     \
  LAW(accel_feedback)        \
  LAW(nullspace)             \
  LAW(damping_design)        \
  LAW(singularity)           \
  LAW(tomei)                 \
  LAW(qbar)                  \
  LAW(flex_rhs)              \
  LAW(vsa_cartesian)         \
  LAW(momentum_seq)
#define LIMBER_FREE_LAWS(LAW) \
  LAW(torque_feedback)        \
  LAW(full_state)             \
  LAW(deflection_pd)          \
  LAW(vsa)                    \
  LAW(interpolation)          \
  LAW(target_stream_seq)      \
  LAW(contact)                \
  LAW(admittance_seq)         \
  LAW(velocity_seq)           \
  LAW(friction_seq)           \
  LAW(tank_seq)               \
  LAW(limit_seq)
// clang-format on

namespace limber::eval {

#define LIMBER_DECLARE(name) Json name(Arm& arm, Inputs& in);
LIMBER_ARM_LAWS(LIMBER_DECLARE)
#undef LIMBER_DECLARE
#define LIMBER_DECLARE(name) Json name(Inputs& in);
LIMBER_FREE_LAWS(LIMBER_DECLARE)
#undef LIMBER_DECLARE

std::span<const LawRow> law_table() {
#define LIMBER_ARM_ROW(name) LawRow{#name, name, nullptr},
#define LIMBER_FREE_ROW(name) LawRow{#name, nullptr, name},
  static const std::array rows{LIMBER_ARM_LAWS(LIMBER_ARM_ROW) LIMBER_FREE_LAWS(LIMBER_FREE_ROW)};
#undef LIMBER_ARM_ROW
#undef LIMBER_FREE_ROW
  return rows;
}

const LawRow& find_law_row(const std::string& name) {
  std::vector<std::string> names;
  for (const LawRow& row : law_table()) {
    if (name == row.name) return row;
    names.emplace_back(row.name);
  }
  const std::string near = nearest_word(name, names);
  throw ConfigError("law: there is no '" + name + "'" +
                    (near.empty() ? "" : ", did you mean '" + near + "'?") +
                    "; there are: " + joined(names));
}

}  // namespace limber::eval
