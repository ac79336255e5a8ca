// Faults between the controller and the gate: answers that are missing, late, doubled, foreign or
// wrong.
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <random>

#include "qa/faults/fault_table.h"

namespace limber::faults {
namespace {

using Answer = joint_command_t;
using Answers = std::vector<joint_command_t>;
using Begin = std::function<void(FaultStage*)>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Begin answers(const FaultStage::AnswerChange& change) {
  return [change](FaultStage* stage) { stage->change_answers(change); };
}

/// The first `count` answers are lost.
Begin lose_answers(int count) {
  return answers([left = count](const Answer& answer, Answers* instead) mutable {
    if (left-- <= 0) instead->push_back(answer);
  });
}

/// Each answer is lost with this probability.
Begin lose_answers_share(double probability) {
  return [probability](FaultStage* stage) {
    stage->change_answers([probability, random = std::minstd_rand(stage->seed())](
                              const Answer& answer, Answers* instead) mutable {
      if (std::uniform_real_distribution<>(0.0, 1.0)(random) >= probability)
        instead->push_back(answer);
    });
  };
}

/// `cycles` answers wait, then all come at once.
Begin frozen(int cycles) {
  return answers([cycles, waiting = Answers()](const Answer& answer, Answers* instead) mutable {
    waiting.push_back(answer);
    if (cycles-- > 0) return;
    *instead = waiting;
    waiting.clear();
  });
}

/// Every answer comes so many cycles late.
Begin late_answers(std::size_t cycles) {
  return answers(
      [cycles, waiting = std::deque<Answer>()](const Answer& answer, Answers* instead) mutable {
        waiting.push_back(answer);
        if (waiting.size() <= cycles) return;
        instead->push_back(waiting.front());
        waiting.pop_front();
      });
}

/// The second of two comes before the first.
void swapped_in_pairs(FaultStage* stage) {
  stage->change_answers([waiting = Answers()](const Answer& answer, Answers* instead) mutable {
    waiting.push_back(answer);
    if (waiting.size() < 2) return;
    instead->assign(waiting.rbegin(), waiting.rend());
    waiting.clear();
  });
}

/// In front of each answer comes another one, changed.
template <typename Change>
Begin other_answer(Change change) {
  return answers([change](const Answer& answer, Answers* instead) {
    Answer other = answer;
    change(&other);
    *instead = {other, answer};
  });
}

/// `count` answers are changed, or, below 0, all. `change(answer, joint 0)`.
template <typename Change>
Begin changed(Change change, int count = -1) {
  return [change, count](FaultStage* stage) {
    stage->change_answers([=, left = count](const Answer& answer, Answers* instead) mutable {
      instead->push_back(answer);
      if (count < 0 || left-- > 0) change(&instead->back(), stage->joint());
    });
  };
}

Begin torque(double value) {
  return changed([value](Answer* answer, const JointConfig&) { answer->tau[0] = value; });
}

/// Torque alternates by so many times what it may step in a cycle.
Begin torque_steps(double times) {
  return [times](FaultStage* stage) {
    const double step = times * stage->joint().torque_rate_limit_Nm_per_s / stage->robot().rate_hz;
    stage->change_answers([step, up = false](const Answer& answer, Answers* instead) mutable {
      instead->push_back(answer);
      up = !up;
      instead->back().tau[0] += up ? step : 0.0;
    });
  };
}

Begin gravity_of_limit(double share, int count) {
  return changed(
      [share](Answer* answer, const JointConfig& joint) {
        answer->tau_gravity[0] = share * joint.torque_limit_Nm;
      },
      count);
}

std::vector<Fault> silent_faults() {
  return {
      {.name = "controller silent", .begin = lose_answers(1'000'000), .most_cycles = 4},
      {.name = "controller frozen for 50 cycles, then all its answers at once",
       .begin = frozen(50),
       .most_cycles = 4},
      {.name = "two answers lost in a row", .begin = lose_answers(2)},
      {.name = "three answers lost in a row", .begin = lose_answers(3), .most_cycles = 4},
      {.name = "20 answers lost in a row", .begin = lose_answers(20), .most_cycles = 4},
      {.name = "1 % of the answers lost", .begin = lose_answers_share(0.01)},
      {.name = "answers ten cycles late", .begin = late_answers(10), .most_cycles = 4},
      {.name = "answers swapped in pairs", .begin = swapped_in_pairs},
      {.name = "every answer twice", .begin = other_answer([](Answer*) {})},
  };
}

std::vector<Fault> foreign_faults() {
  return {
      {.name = "a second controller",
       .begin = other_answer([](Answer* other) { other->controller ^= 0x5A5A; })},
      {.name = "answers of another session",
       .begin = other_answer([](Answer* other) { other->session ^= 0x5A5A; })},
      {.name = "old answers again",
       .begin = other_answer([](Answer* other) { other->state_seq -= 500; })},
      {.name = "answers to states that were never sent",
       .begin = other_answer([](Answer* other) { other->state_seq += 1'000'000; }),
       .most_cycles = 4},
  };
}

std::vector<Fault> wrong_faults() {
  return {
      {.name = "torque NaN", .begin = torque(std::nan("")), .most_cycles = 4},
      {.name = "torque infinite", .begin = torque(kInfinity), .most_cycles = 4},
      {.name = "torque 1e308", .begin = torque(1e308), .most_cycles = 4},
      {.name = "gravity NaN",
       .begin = changed(
           [](Answer* answer, const JointConfig&) { answer->tau_gravity[0] = std::nan(""); }),
       .most_cycles = 4},
      {.name = "torque beyond the limit",
       .begin = changed([](Answer* answer, const JointConfig& joint) {
         answer->tau[0] = 1.1 * joint.torque_limit_Nm;
       }),
       .most_cycles = 4},
      {.name = "torque steps beyond the limit", .begin = torque_steps(4.0), .most_cycles = 6},
      {.name = "gravity torque wrong by the limit",
       .begin = gravity_of_limit(0.9, -1),
       .most_cycles = 4},
      {.name = "gravity torque wrong once", .begin = gravity_of_limit(-0.9, 1)},
      {.name = "a command for more joints",
       .begin = changed([](Answer* answer, const JointConfig&) { ++answer->num_joints; }),
       .most_cycles = 4},
      {.name = "an unknown request",
       .begin = changed([](Answer* answer, const JointConfig&) { answer->request = 77; }),
       .most_cycles = 4},
  };
}

}  // namespace

std::vector<Fault> controller_faults() {
  std::vector<Fault> all = silent_faults();
  for (const std::vector<Fault>& more : {foreign_faults(), wrong_faults()})
    all.insert(all.end(), more.begin(), more.end());
  for (Fault& fault : all) fault.place = Place::kController;
  return all;
}

}  // namespace limber::faults
