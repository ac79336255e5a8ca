// All laws that can be evaluated, by name.
#pragma once

#include <span>
#include <string>

#include "lecture/eval/arm.h"

namespace limber::eval {

/// Reads the inputs of one case and returns its outputs. Throws ConfigError. A law has one of the
/// two.
struct LawRow {
  const char* name;
  Json (*with_arm)(Arm& arm, Inputs& in);
  Json (*alone)(Inputs& in);
};

std::span<const LawRow> law_table();

/// Throws ConfigError naming all laws if there is none of this name.
const LawRow& find_law_row(const std::string& name);

}  // namespace limber::eval
