#include "scenarios/loader/hand_yaml.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/complaints.h"
#include "scenarios/loader/scenario.h"
#include "scenarios/loader/values_yaml.h"

namespace limber {
namespace {

constexpr double kPress_m = 0.02;  // as hand_goal_t

ObjectConfig read_object(const YamlMap& yaml) {
  ObjectConfig object;
  object.name = yaml.name("name");
  const auto position = yaml.numbers("position_m", 3, kPositionRange_m);
  std::copy(position.begin(), position.end(), object.p_B);
  object.width_m = yaml.number("width_m", {1e-4, 1.0});
  object.stiffness_N_per_m = yaml.number("stiffness_N_per_m", {1.0, 1e7});
  object.damping_Ns_per_m = yaml.number_or("damping_Ns_per_m", {0.0, 1e5}, 0.0);
  object.mass_kg = yaml.number("mass_kg", {1e-3, 100.0});
  object.friction = yaml.number("friction", {0.0, 10.0});
  yaml.finish();
  return object;
}

}  // namespace

hand_goal_t read_hand_goal(const YamlMap& yaml, const Robot& robot) {
  if (!robot.hand) yaml.refuse(fmt::format("{} has no hand in robot.yaml", robot.name));
  const HandConfig& hand = *robot.hand;
  hand_goal_t goal{};
  goal.client = kScenarioClient;
  goal.width_m = yaml.number("width_m", {-kPress_m, hand.travel.open_m()});
  goal.force_N = yaml.number_or("force_N", {0.0, hand.force_limit_N}, 0.0);
  goal.speed_m_per_s = yaml.number_or("speed_m_per_s", {0.0, hand.speed_limit_m_per_s}, 0.0);
  yaml.finish();
  return goal;
}

std::vector<ObjectConfig> read_objects(const YamlMap& yaml, const Robot& robot) {
  std::vector<ObjectConfig> objects;
  if (!yaml.has("objects")) return objects;
  if (!robot.hand)
    yaml.refuse("objects", fmt::format("{} has no hand in robot.yaml to meet them", robot.name));
  Complaints complaints(yaml.file());
  for (const YamlMap& entry : yaml.maps("objects")) {
    complaints.collect([&] {
      const ObjectConfig object = read_object(entry);
      if (std::ranges::find(objects, object.name, &ObjectConfig::name) != objects.end())
        entry.refuse("name", "is taken by another object");
      objects.push_back(object);
    });
  }
  complaints.throw_if_any();
  if (objects.size() > kMostObjects)
    yaml.refuse("objects", fmt::format("found {}; at most {}", objects.size(), kMostObjects));
  return objects;
}

}  // namespace limber
