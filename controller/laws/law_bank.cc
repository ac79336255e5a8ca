#include "controller/laws/law_bank.h"

#include "common/config_error.h"
#include "common/suggest.h"

namespace limber::controller {

LawBank::LawBank(const LawArm& arm, const std::string& selected, bool simulated)
    : sensors_(sensors_of(arm.robot)),
      simulated_(simulated),
      hold_(find("joint_pd")),
      selected_(find(selected)),
      running_(hold_) {
  for (const LawEntry& entry : controller::laws()) {
    const bool possible = check_law(entry, sensors_) == nullptr;
    laws_.push_back(possible ? entry.make(arm) : nullptr);
  }
}

int LawBank::find(const std::string& name) const {
  const int index = find_law(name);
  if (index < 0) {
    throw ConfigError("no control law is called '" + name + "'; there are " +
                      joined(law_catalog().names));
  }
  if (const char* reason = check_entry(entry(index))) throw ConfigError(name + ": " + reason);
  return index;
}

const char* LawBank::check_entry(const LawEntry& entry) const noexcept {
  if (const char* reason = check_law(entry, sensors_)) return reason;
  return entry.demonstration && !simulated_
             ? "the law demonstrates a mistake and is allowed only where every bus is simulated"
             : nullptr;
}

const char* LawBank::check(int law, const Gains& gains) const noexcept {
  if (const char* reason = check_entry(entry(law))) return reason;
  if (const char* reason = check_settings(gains.settings, sensors_)) return reason;
  const PositionFeedback position = gains.settings.position_feedback;
  if (const char* reason = check_position(position, entry(law), sensors_)) return reason;
  return laws_[static_cast<std::size_t>(law)]->check(gains);
}

}  // namespace limber::controller
