#include "controller/laws/registry.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/config_error.h"
#include "controller/laws/law_files.h"

// One line a law. The order is the numbering of controller_status_t.law: append, do not insert.
#define LIMBER_LAWS(LAW)      \
  LAW(gravity_compensation)   \
  LAW(joint_pd)               \
  LAW(cartesian_impedance)    \
  LAW(salisbury)              \
  LAW(congruence_stiffness)   \
  LAW(mapped_joint_impedance) \
  LAW(multirate_impedance)    \
  LAW(computed_torque)        \
  LAW(pd_plus)                \
  LAW(joint_impedance)        \
  LAW(opspace_impedance)      \
  LAW(accel_feedback)         \
  LAW(admittance)             \
  LAW(tomei)                  \
  LAW(full_state)             \
  LAW(deflection_pd)          \
  LAW(flatness)               \
  LAW(variable_stiffness)

namespace limber::controller {

#define LIMBER_DECLARE(name) LawEntry name##_law();
LIMBER_LAWS(LIMBER_DECLARE)
#undef LIMBER_DECLARE

namespace {

std::string_view name_of(const LawEntry& entry) { return entry.name; }

struct Registry {
  std::vector<LawEntry> entries;
  LawCatalog catalog;
};

Registry make_registry(const std::vector<LawEntry>& others) {
#define LIMBER_ENTRY(name) name##_law(),
  Registry all{{LIMBER_LAWS(LIMBER_ENTRY)}, {}};
#undef LIMBER_ENTRY
  for (const LawEntry& other : others) {
    const auto same = std::ranges::find(all.entries, std::string_view(other.name), &name_of);
    if (same != all.entries.end())
      throw ConfigError(fmt::format("there are two laws called '{}'; rename yours", other.name));
    all.entries.push_back(other);
  }
  int scalars = 0;
  int matrices = 0;
  for (const LawEntry& entry : all.entries) {
    all.catalog.names.emplace_back(entry.name);
    for (GainRow* row : entry.parameters) {
      row->slot = row->per_joint ? matrices++ : scalars++;
      all.catalog.parameters.push_back(row);
    }
  }
  if (scalars > LawParameters::kMostScalars || matrices > LawParameters::kMostMatrices) {
    throw ConfigError("the laws declare more parameters than LawParameters has room for");
  }
  return all;
}

Registry& registry() noexcept {
  static Registry all = make_registry({});
  return all;
}

}  // namespace

void load_laws(const std::vector<std::string>& files) {
  registry() = make_registry(open_law_files(files));
}

std::span<const LawEntry> laws() noexcept { return registry().entries; }

const LawCatalog& law_catalog() noexcept { return registry().catalog; }

int find_law(const std::string& name) noexcept {
  const std::span<const LawEntry> all = laws();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (name == all[i].name) return static_cast<int>(i);
  }
  return -1;
}

const char* check_law(const LawEntry& law, unsigned available) noexcept {
  const unsigned missing = law.needs & ~available;
  if ((missing & sensors::kLinkEncoder) != 0) return "the law needs link encoders";
  if ((missing & sensors::kMotorEncoder) != 0) return "the law needs motor encoders";
  if ((missing & sensors::kTorqueSensor) != 0) return "the law needs joint torque sensors";
  if ((missing & sensors::kTipForceSensor) != 0) return "the law needs a force sensor at the tip";
  if ((missing & sensors::kElasticJoints) != 0) {
    return "the law needs an elastic joint (transmission: elastic) everywhere";
  }
  if ((missing & sensors::kTwoMotors) != 0) {
    return "the law needs two motors at every joint (transmission: antagonistic)";
  }
  if ((missing & sensors::kDeflection) != 0) {
    return "the law needs the springs' deflection: a link encoder or a torque sensor at every "
           "joint";
  }
  return nullptr;
}

const char* check_settings(const LawSettings& settings, unsigned available) noexcept {
  if (settings.contact == ContactSource::kTipSensor &&
      (available & sensors::kTipForceSensor) == 0) {
    return "contact: the arm has no force sensor at the tip";
  }
  if (settings.friction_compensation == FrictionCompensation::kObserver &&
      (available & sensors::kTorqueSensor) == 0) {
    return "friction_compensation: the observer needs joint torque sensors";
  }
  if (settings.friction_compensation == FrictionCompensation::kDither &&
      (available & sensors::kSprings) != 0) {
    return "friction_compensation: dither would shake the springs of elastic joints; choose the "
           "observer where there are torque sensors, else model";
  }
  return nullptr;
}

const char* check_position(PositionFeedback position, const LawEntry& law,
                           unsigned available) noexcept {
  if ((available & sensors::kSprings) == 0) return nullptr;
  if (position == PositionFeedback::kLink && (available & sensors::kLinkEncoder) == 0) {
    return "position_feedback: link needs link encoders";
  }
  if (position == PositionFeedback::kStatic && law.potential == Potential::kNone) {
    return "position_feedback: the law has no static potential (its torque at rest is no spring's "
           "at the "
           "link); "
           "choose motor or link";
  }
  return nullptr;
}

}  // namespace limber::controller
