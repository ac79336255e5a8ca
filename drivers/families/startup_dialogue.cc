#include "drivers/families/startup_dialogue.h"

#include <fmt/format.h>

namespace limber {

std::string StartupDialogue::describe(const StartupFailure& failure) const {
  if (failure.reg == 0) return "could not be disabled, or does not answer";
  if (failure.answer == Answer::kNone) return fmt::format("register {} not answered", failure.reg);
  return fmt::format("register {} is {:g}, expected {:g}", failure.reg, failure.found,
                     failure.expected);
}

}  // namespace limber
