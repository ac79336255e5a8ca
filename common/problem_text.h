// Faults, refusals and limits in words; the words are in lcmtypes/problems.yaml.
#pragma once

#include <span>
#include <string>

#include "lcmtypes/problems.h"

namespace limber {

/// The entry for a constant of the group's message; nullptr if it is no problem, or unknown. May be
/// called in the cycle.
const Problem* find_problem(std::span<const Problem> group, int value) noexcept;

/// For a log: "driver.POSITION: WHAT (WHERE): DETAIL; REMEDY; see docs/troubleshooting.md". Empty
/// `where` and `detail` are left out; a value without an entry is "unknown number 77". Allocates.
std::string problem_text(std::span<const Problem> group, int value, const std::string& where,
                         const std::string& detail);

/// The same of a request that was refused, whose own reason stands instead of the entry's.
std::string refusal_text(int code, const std::string& reason);

}  // namespace limber
