#include "controller/list_laws.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "controller/laws/registry.h"
#include "robots/loader/load_robot.h"

namespace limber::controller {
namespace {

using Json = nlohmann::ordered_json;

const char* kind_of(const GainRow& row) {
  using M = compliance_gains_t;
  if (&row == &translation_stiffness_row() || &row == &rotation_stiffness_row()) return "blocks";
  if (std::holds_alternative<std::int16_t(M::*)[5]>(row.field)) return "periods";
  if (row.high_rotation > 0.0) return "tip_matrix";
  if (row.is_choice()) return row.is_switch() ? "switch" : "choice";
  const bool joints = row.per_joint || std::holds_alternative<double(M::*)[16]>(row.field) ||
                      std::holds_alternative<float(M::*)[16]>(row.field);
  return joints ? "joints" : "number";
}

Json default_of(const GainRow& row, const std::string& kind) {
  if (row.from_robot) return "robot.yaml";
  if (kind != "choice" && kind != "switch") return row.standard;
  for (const GainWord& word : row.words) {
    if (word.value == static_cast<int>(row.standard)) return word.word;
  }
  return nullptr;
}

Json json_of(const GainRow& row) {
  const std::string kind = kind_of(row);
  Json json = {{"key", row.key}, {"meaning", row.meaning}, {"kind", kind}};
  if (row.unit[0] != '\0') json["unit"] = row.unit;
  if (row.is_choice()) {
    json["words"] = Json::array();
    for (const GainWord& word : row.words) {
      json["words"].push_back({{"word", word.word}, {"demonstration", word.demonstration}});
    }
  }
  if (kind != "choice" && kind != "switch") {
    json["low"] = row.low;
    json["high"] = row.high;
  }
  if (row.high_rotation > 0.0) json["high_rotation"] = row.high_rotation;
  json["default"] = default_of(row, kind);
  return json;
}

Json needs_of(const LawEntry& law) {
  constexpr std::pair<unsigned, const char*> kNames[] = {
      {sensors::kLinkEncoder, "link encoders"},
      {sensors::kMotorEncoder, "motor encoders"},
      {sensors::kTorqueSensor, "joint torque sensors"},
      {sensors::kTipForceSensor, "tip force sensor"},
      {sensors::kElasticJoints, "elastic joints"},
      {sensors::kTwoMotors, "two motors a joint"},
      {sensors::kDeflection, "measured deflection of the springs"}};
  Json needs = Json::array();
  for (const auto& [sensor, name] : kNames) {
    if ((law.needs & sensor) != 0) needs.push_back(name);
  }
  return needs;
}

const char* goal_of(GoalType type) {
  switch (type) {
    case GoalType::kPose:
      return "pose";
    case GoalType::kJoints:
      return "joints";
    case GoalType::kJointsAndWrench:
      return "joints and wrench";
    case GoalType::kSmoothJoints:
      return "smooth joints";
    case GoalType::kNone:
      break;
  }
  return "none";
}

Json json_of(const LawEntry& law, const LoadedRobot* robot) {
  Json json = {{"name", law.name},
               {"summary", law.summary},
               {"needs", needs_of(law)},
               {"goal", goal_of(law.goal_type)},
               {"demonstration", law.demonstration},
               {"parameters", Json::array()},
               {"reports", Json::array()}};
  for (const GainRow* row : law.parameters) json["parameters"].push_back(json_of(*row));
  for (const LawReport& report : law.reports) {
    json["reports"].push_back({{"key", report.key},
                               {"unit", report.unit},
                               {"meaning", report.meaning},
                               {"per_joint", report.per_joint}});
  }
  if (robot != nullptr) {
    const char* refusal = check_law(law, sensors_of(robot->robot));
    json["refusal"] = refusal == nullptr ? Json(nullptr) : Json(refusal);
  }
  return json;
}

}  // namespace

std::string list_laws() {
  std::string lines;
  for (const LawEntry& law : laws()) lines += fmt::format("{:<24} {}\n", law.name, law.summary);
  return lines;
}

std::string list_laws_json(const LoadedRobot* robot) {
  Json json = {{"gains", Json::array()}, {"laws", Json::array()}};
  json["gains"].push_back(json_of(ramp_row()));
  json["gains"].push_back(json_of(translation_stiffness_row()));
  json["gains"].push_back(json_of(rotation_stiffness_row()));
  for (const GainRow& row : gain_table()) json["gains"].push_back(json_of(row));
  for (const LawEntry& law : laws()) json["laws"].push_back(json_of(law, robot));
  return json.dump(2) + "\n";
}

}  // namespace limber::controller
