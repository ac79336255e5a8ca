// All control laws by name.
#pragma once

#include <span>
#include <string>

#include "controller/laws/law.h"

namespace limber::controller {

/// In the order of controller_status_t.law.
std::span<const LawEntry> laws() noexcept;

/// Index of a name, -1 if there is none. May be called in the cycle.
int find_law(const std::string& name) noexcept;

/// What this arm has, sensors::*. A rigidly geared joint's encoder serves both sides.
unsigned sensors_of(const Robot& robot) noexcept;

/// nullptr if an arm with these sensors can run the law, else why not. May be called in the cycle.
const char* refuse_law(const LawEntry& law, unsigned available) noexcept;

/// The same for the side of elastic joints it shall look at.
const char* refuse_position(Position position, const LawEntry& law, unsigned available) noexcept;

/// The same for what the settings ask of the arm, whatever the law.
const char* refuse_settings(const LawSettings& settings, unsigned available) noexcept;

}  // namespace limber::controller
