// What the controller can run and which numbers it takes, for people and for programs.
#pragma once

#include <string>

#include "robots/loader/load_robot.h"

namespace limber::controller {

/// One line a law: name and summary.
std::string list_laws();

/// The same as JSON, with everything that a reader of gains has to know:
///   {"gains": [row], "laws": [{"name", "summary", "needs": [word], "goal", "demonstration",
///    "parameters": [row], "reports": [{"key", "unit", "meaning", "per_joint"}], "refusal"}]}
///   row: {"key", "meaning", "kind", "unit", "low", "high", "high_rotation", "words", "default"}
/// kind: number, choice, switch, joints (one number a joint), tip_matrix, blocks (one or three
/// numbers), periods. default: a number, a word, or "robot.yaml". `robot`: the arm for which
/// "refusal" says why it cannot run a law (null: it can); nullptr: no arm, no "refusal".
std::string list_laws_json(const LoadedRobot* robot);

}  // namespace limber::controller
