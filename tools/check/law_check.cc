#include "tools/check/law_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numbers>

#include "controller/laws/registry.h"
#include "tools/allocations/allocations.h"
#include "tools/check/random_arm.h"

extern "C" std::int64_t limber_allocations() noexcept __attribute__((weak));  // in the program

namespace limber {
namespace {

using namespace controller;

constexpr int kCases = 320;
constexpr double kStep_rad = 1e-6;  // of the numerical gradient

/// Something that has to hold, and how often it did.
struct Rule {
  const char* text;
  int tried = 0;
  std::string broken = {};  ///< the first case in which it did not
};

/// The law with an arm, and all that it receives.
struct Trial {
  Trial(const LawEntry& entry, const LoadedRobot& loaded)
      : arm(loaded),
        model(arm),
        terms(arm.robot.size()),
        point(arm.robot.size()),
        state(arm.robot.size()),
        goal(arm.robot.size()),
        gains(arm.robot.size(), law_catalog().parameters),
        estimates(arm.robot.size()),
        output(arm.robot.size()),
        law(entry.make({arm.robot, model})) {}

  LawInputs inputs() const {
    return {.point = point,
            .state = state,
            .terms = terms,
            .goal = goal,
            .gains = gains,
            .estimates = estimates,
            .dt_s = 1e-3};
  }
  void go_to(const VectorJ& q, const VectorJ& v) {
    point.q = state.q = state.theta = q;
    point.v = state.v = state.theta_dot = v;
    model.evaluate(q, v, &terms);
  }
  const LawOutput& compute() {
    output.reset();
    law->compute(inputs(), &output);
    return output;
  }
  double energy_at(const VectorJ& q) {
    go_to(q, VectorJ::Zero(q.size()));
    return compute().spring_energy_J;
  }

  LoadedRobot arm;
  ArmModel model;
  ArmTerms terms;
  ControlPoint point;
  ArmState state;
  Goal goal;
  Gains gains;
  Estimates estimates;
  LawOutput output;
  std::unique_ptr<Law> law;
};

bool finite(const LawOutput& output) {
  return output.tau().allFinite() && output.F.allFinite() && std::isfinite(output.spring_energy_J);
}

class Tester {
 public:
  explicit Tester(const LawEntry& entry) : entry_(entry) {}

  void run() {
    for (int i = 0; i < kCases; ++i) try_case(i);
  }

  std::string table(bool* passed) const {
    std::string text = fmt::format("{}: {}\n", entry_.name, entry_.summary);
    *passed = taken_ > 0;
    for (const Rule* rule : {&allocation_, &finite_, &half_turn_, &singular_, &damper_, &spring_}) {
      const bool holds = rule->broken.empty();
      *passed = *passed && holds;
      text += fmt::format("  {:<58} {}\n", rule->text,
                          !holds             ? "WRONG: " + rule->broken
                          : rule->tried == 0 ? "not claimed"
                                             : fmt::format("ok in {}", rule->tried));
    }
    text += fmt::format(
        "  {} of {} random arms with gains that the law takes; one cycle takes "
        "{:.2f} us at most, the model's terms not counted\n",
        taken_, kCases, static_cast<double>(longest_ns_) * 1e-3);
    if (taken_ == 0) text += "  WRONG: the law refuses all gains\n";
    return text;
  }

 private:
  void try_case(int number) {
    RandomArm random(number);
    const int n = 1 + number % 16;
    case_ = fmt::format("case {}, {} joints", number, n);
    Trial trial(entry_, random.arm(n, entry_.needs));
    random.choose(&trial.gains);
    if (trial.law->check(trial.gains) != nullptr) return;
    ++taken_;
    const VectorJ q = random.joints(n, 2.0);
    const VectorJ q_d = q + random.joints(n, 0.3);
    trial.goal.X_BD = trial.model.tip_pose(q_d);
    trial.goal.q_d = trial.goal.q_null = q_d;
    const VectorJ v = random.joints(n, 1.0);
    at_rest(&trial, q, v);
    moving_goal(&trial, &random, q, v);
    extremes(&trial, q, v);
  }

  void hold(Rule* rule, bool holds, const std::string& what) {
    ++rule->tried;
    if (!holds && rule->broken.empty()) rule->broken = case_ + ": " + what;
  }

  /// Spring and damper, with a goal that stays where it is.
  void at_rest(Trial* trial, const VectorJ& q, const VectorJ& v) {
    trial->go_to(q, v);
    trial->law->start(trial->inputs());
    const LawOutput output = trial->compute();
    hold(&finite_, finite(output), "a torque, wrench or energy is not finite");
    const double power = v.dot(output.tau_damping);
    hold(&damper_, power <= 1e-9 * (1.0 + v.norm() * output.tau_damping.norm()),
         fmt::format("tau_damping puts {:.3g} W into the arm", power));
    if (output.spring_energy_J == 0.0) return;
    const VectorJ d = v.normalized();
    const double slope =
        (trial->energy_at(q + kStep_rad * d) - trial->energy_at(q - kStep_rad * d)) /
        (2.0 * kStep_rad);
    trial->go_to(q, VectorJ::Zero(q.size()));
    const double pull = d.dot(trial->compute().tau_stiffness);
    const double scale = 1.0 + trial->output.tau_stiffness.norm();
    hold(&spring_, std::abs(slope + pull) <= 1e-4 * scale,
         fmt::format("energy falls by {:.6g} J/rad, and tau_stiffness pulls with {:.6g} N m",
                     -slope, pull));
  }

  void moving_goal(Trial* trial, RandomArm* random, const VectorJ& q, const VectorJ& v) {
    const int n = static_cast<int>(q.size());
    random->move(n, &trial->goal, &trial->estimates);
    trial->go_to(q, v);
    const std::int64_t before = allocations();
    trial->law->start(trial->inputs());
    const auto begin = std::chrono::steady_clock::now();
    const LawOutput& output = trial->compute();
    const auto took = std::chrono::steady_clock::now() - begin;
    const bool none = allocations() == before;
    hold(&allocation_, none, "start() or compute() allocates memory");
    hold(&finite_, finite(output), "a torque, wrench or energy is not finite");
    if (trial->law->preload() != nullptr)
      hold(&finite_, trial->law->preload()->allFinite(), "the preload is not finite");
    longest_ns_ = std::max<std::int64_t>(longest_ns_, std::chrono::nanoseconds(took).count());
  }

  void extremes(Trial* trial, const VectorJ& q, const VectorJ& v) {
    trial->go_to(q, v);
    const Eigen::AngleAxisd half_a_turn(std::numbers::pi, Eigen::Vector3d(1, -2, 3).normalized());
    trial->goal.X_BD.Q = half_a_turn * trial->terms.X_BT.Q;
    trial->law->start(trial->inputs());
    hold(&half_turn_, finite(trial->compute()), "not finite");
    for (const double bend : {1e-3, 1e-9, 0.0}) {
      trial->go_to(VectorJ::Constant(q.size(), bend), v);
      trial->law->start(trial->inputs());
      hold(&singular_, finite(trial->compute()), fmt::format("not finite at q = {}", bend));
    }
  }

  const LawEntry& entry_;
  std::string case_;
  int taken_ = 0;
  std::int64_t longest_ns_ = 0;
  Rule allocation_{.text = "no memory is allocated in a cycle"};
  Rule finite_{.text = "torques, wrench and energy are finite"};
  Rule half_turn_{.text = "finite with the goal half a turn away"};
  Rule singular_{.text = "finite where the arm is stretched"};
  Rule damper_{.text = "tau_damping takes power, v^T tau_damping <= 0"};
  Rule spring_{.text = "tau_stiffness is the gradient of spring_energy_J"};
};

[[noreturn]] void tell_and_end() {
  std::fputs("the law threw an exception: it may not, in the cycle nobody catches it\n", stderr);
  std::_Exit(1);
}

}  // namespace

std::string check_law_file(const std::string& file, bool* passed) {
  ::unsetenv("LIMBER_LAWS");  // this one alone, which is then the last
  load_laws({file});
  std::set_terminate(tell_and_end);
  Tester tester(laws().back());
  tester.run();
  return tester.table(passed);
}

}  // namespace limber
