// The one table of what a gains message holds: key, words or range, unit, default, meaning.
//
// The reader of scenarios and requests, the checker in the controller, the defaults, the tables in
// scenarios/README.md and `limber-controller --list-laws --json` all come from it. A number that
// belongs to one law is a row of the same kind in that law's file (GainRow::field is empty); its
// value travels in compliance_gains_t::parameters.
#pragma once

#include <cstdint>
#include <limber/compliance_gains_t.hpp>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace limber {

struct GainWord {
  const char* word;
  int value;  ///< the message's constant
  /// Demonstrates a mistake; refused unless every bus is simulated.
  bool demonstration = false;
};

/// Where a row stands in the message; its type says what kind of quantity it is.
using GainField = std::variant<std::monostate,                            // a parameter of one law
                               double compliance_gains_t::*,              // a number
                               float compliance_gains_t::*,               // a number
                               std::int8_t compliance_gains_t::*,         // a choice
                               double (compliance_gains_t::*)[16],        // one number a joint
                               float (compliance_gains_t::*)[16],         // one number a joint
                               double (compliance_gains_t::*)[6][6],      // a symmetric tip matrix
                               float (compliance_gains_t::*)[6][6],       // a symmetric tip matrix
                               std::int16_t (compliance_gains_t::*)[5]>;  // a number for each word

struct GainRow {
  const char* key;
  const char* meaning;
  const char* unit = "";
  double low = 0.0;
  double high = 0.0;
  /// Bound of the rotational half of a tip matrix's diagonal; `high` bounds the translational one.
  double high_rotation = 0.0;
  /// Value where nobody names one; of a choice the word's value.
  double standard = 0.0;
  bool from_robot = false;               ///< the default is robot.yaml's
  std::span<const GainWord> words = {};  ///< a choice, or the parts of the period map
  bool per_joint = false;                ///< of a law's parameter; message fields have their type
  bool ramps = false;                    ///< of a law's joint parameter: changes along the ramp
  GainField field = {};
  int slot = -1;  ///< of a law's parameter: where Gains keeps it, given by the registry

  bool is_choice() const noexcept { return !words.empty(); }
  bool is_switch() const noexcept {
    return is_choice() && words[0].word == std::string_view("false");
  }
};

/// What a reader of scenarios and requests has to know of the control laws: their names and the
/// parameters that they declare. The controller's registry makes it.
struct LawCatalog {
  std::vector<std::string> names;
  std::vector<const GainRow*> parameters;
};

/// All rows that are fields of the message, in the order they are shown.
std::span<const GainRow> gain_table() noexcept;

/// The diagonal blocks of K_x may be given alone: rows without a field, read into K_x.
const GainRow& translation_stiffness_row() noexcept;
const GainRow& rotation_stiffness_row() noexcept;
/// `ramp_s`.
const GainRow& ramp_row() noexcept;

/// A message with every field at its default; those from robot.yaml are zero, the law is empty.
compliance_gains_t standard_gains();

/// Puts the value of a law's parameter into the message, in the place of one that is there.
void set_parameter(const std::string& key, std::vector<float> values, compliance_gains_t* gains);

/// The row of a key among `rows`, nullptr if there is none. May be called in the cycle.
const GainRow* find_row(std::span<const GainRow* const> rows, std::string_view key) noexcept;

/// Off and on of a switch.
std::span<const GainWord> switch_words() noexcept;

}  // namespace limber
