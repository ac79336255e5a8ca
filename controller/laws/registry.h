// All control laws by name.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "controller/laws/law.h"
#include "lcmtypes/gains_table.h"

namespace limber::controller {

/// Adds the laws of shared libraries (law_files.h), whose numbers follow those of limber's own.
/// Before the others are called; a program that does not call it has limber's laws alone. Throws
/// ConfigError. Set-up only.
void load_laws(const std::vector<std::string>& files = {});

/// In the order of controller_status_t.law. The first call is for set-up; later ones may be made in
/// the cycle.
std::span<const LawEntry> laws() noexcept;

/// Names and parameters of all laws, for readers and checkers. As laws().
const LawCatalog& law_catalog() noexcept;

/// Index of a name, -1 if there is none. May be called in the cycle.
int find_law(const std::string& name) noexcept;

/// nullptr if an arm with these sensors can run the law, else why not. May be called in the cycle.
const char* check_law(const LawEntry& law, unsigned available) noexcept;

/// The same for a law and the position it is to receive on elastic joints.
const char* check_position(PositionFeedback position, const LawEntry& law,
                           unsigned available) noexcept;

/// The same for what the settings need of the arm, whatever the law.
const char* check_settings(const LawSettings& settings, unsigned available) noexcept;

}  // namespace limber::controller
