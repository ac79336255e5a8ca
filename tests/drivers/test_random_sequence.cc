// Four hundred thousand cycles of a bad day: a careless controller, strangers, lost frames, failing
// drives. An oracle that reads nothing but the bytes on the bus and what was offered decides
// whether anything reached a motor that must not.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <deque>
#include <limits>
#include <random>
#include <set>

#include "tests/drivers/fake_arm.h"

namespace limber::test_random_sequence {
namespace {

using testing::FakeArm;
using testing::FakeMotor;
using testing::is_special;
using testing::raw_command;

constexpr int kJoints = 3;
constexpr double kLimit = 8.0;
constexpr double kStep = 0.5;
constexpr double kCount = 20.0 / 4095.0;
/// Commands are refused for so long at the most before the drives hold the arm: three refusals.
constexpr std::int64_t kRemembered = 100;

/// What a controller asked for that was fit to be obeyed, as far as one command tells by itself.
struct Offer {
  std::int64_t cycle = 0;
  std::array<double, kJoints> tau{};
  std::array<double, kJoints> gravity{};
};

class Oracle {
 public:
  explicit Oracle(const FakeArm& arm) : arm_(arm) {}

  void offered(const joint_command_t& command, std::int64_t cycle) {
    if (command.session != FakeArm::kSession || command.num_joints != kJoints) return;
    Offer offer;
    offer.cycle = cycle;
    for (int i = 0; i < kJoints; ++i) {
      const auto j = static_cast<std::size_t>(i);
      offer.tau[j] = command.tau[i];
      offer.gravity[j] = command.tau_gravity[i];
      if (!(command.tau[i] >= -kLimit && command.tau[i] <= kLimit)) return;
      if (!(command.tau_gravity[i] >= -kLimit && command.tau_gravity[i] <= kLimit)) return;
    }
    offers_.push_back(offer);
  }

  /// After a cycle: one frame for each motor, one question at most, and no frame that must not be.
  void judge(std::int64_t cycle) {
    while (!offers_.empty() && offers_.front().cycle < cycle - kRemembered) offers_.pop_front();
    for (std::size_t j = 0; j < kJoints; ++j) {
      const FakeMotor& motor = arm_.motors[j];
      ASSERT_EQ(motor.frames.size(), 1U) << "joint " << j << " cycle " << cycle;
      judge_frame(j, motor.frames[0], cycle);
      if (::testing::Test::HasFatalFailure()) return;
    }
    judge_questions();
    if (::testing::Test::HasFatalFailure()) return;
    std::copy_n(arm_.state->q, kJoints, published_q_.begin());
    std::copy_n(arm_.state->tau_applied, kJoints, applied_.begin());
    // What may hold the arm is what was offered when HOLD began.
    const bool hold = arm_.state->drive_state == joint_state_t::DRIVE_HOLD;
    if (hold && !was_hold_) held_ = offers_;
    was_hold_ = hold;
  }

  std::int64_t torque_frames = 0;
  std::int64_t hold_frames = 0;

 private:
  void judge_questions() {
    std::size_t questions = 0;
    for (const FakeMotor& motor : arm_.motors) {
      questions += motor.questions.size();
      for (const CanFrame& frame : motor.questions)
        ASSERT_TRUE(std::set<int>({9, 10, 21, 22, 23}).contains(frame.data[3]));
    }
    ASSERT_LE(questions, 1U);
  }

  void judge_frame(std::size_t j, const CanFrame& frame, std::int64_t cycle) {
    ASSERT_EQ(frame.length, 8);
    if (frame.id == 0x7FF) {
      ASSERT_TRUE(frame.data[2] == 0x33 || frame.data[2] == 0x55 || frame.data[2] == 0xCC);
      const bool writes = frame.data[2] == 0x55;
      ASSERT_TRUE(!writes || frame.data[3] == 9 || frame.data[3] == 10);
      before_[j] = Kind::kOther;
      return;
    }
    if (is_special(frame)) {
      ASSERT_NE(frame.data[7], 0xFE) << "nobody asked for a new zero";
      before_[j] = Kind::kOther;
      return;
    }
    const auto raw = raw_command(frame);
    const double sign = arm_.robot.joints[j].drive.sign;
    const double tau = sign * (-10.0 + raw.t * kCount);
    ASSERT_LE(std::abs(tau), kLimit + 1e-9);
    // FALLBACK may begin without damping, too: see Fallback.
    const bool holds = arm_.state->drive_state != joint_state_t::DRIVE_ON &&
                       !offered_lately(j, tau, &Offer::tau, cycle);
    if (raw.kp == 0 && raw.kd == 0 && !holds) {
      judge_torque(j, tau, cycle);
    } else {
      judge_hold(j, raw, tau, cycle);
    }
  }

  void judge_torque(std::size_t j, double tau, std::int64_t cycle) {
    ++torque_frames;
    const double largest_step = kStep + 2.0 * kCount;
    if (before_[j] == Kind::kTorque) {
      ASSERT_LE(std::abs(tau - last_[j]), largest_step) << "cycle " << cycle;
    } else if (before_[j] == Kind::kOther) {  // after enabling: from zero
      ASSERT_LE(std::abs(tau), largest_step);
    }
    before_[j] = Kind::kTorque;
    last_[j] = tau;
    ASSERT_TRUE(offered_lately(j, tau, &Offer::tau, cycle)) << "joint " << j << " got " << tau;
  }

  void judge_hold(std::size_t j, const testing::RawCommand& raw, double tau, std::int64_t cycle) {
    ++hold_frames;
    ASSERT_LE(raw.kd, 819);  // less where it would be a step
    ASSERT_TRUE(raw.kp == 0 || raw.kp == 410) << raw.kp;
    // Never a step, but from zero where the drive was off; and towards a gravity torque that was
    // offered before.
    const double largest_step = kStep + 2.02 * kCount;
    if (before_[j] != Kind::kOther && std::abs(tau) > largest_step) {
      // Or from what spring and damping made as well, where HOLD began anew.
      ASSERT_LE(std::min(std::abs(tau - last_[j]), std::abs(tau - applied_[j])), largest_step)
          << "joint " << j << " is held with " << tau << " after " << last_[j] << " in cycle "
          << cycle;
    }
    before_[j] = Kind::kFallback;
    const auto offered_before = [&](auto fits) {
      return std::ranges::any_of(held_, fits) || std::ranges::any_of(offers_, fits);
    };
    const bool towards = offered_before(
        [&](const Offer& offer) { return (offer.gravity[j] - tau) * (tau - last_[j]) > 0.0; });
    const bool gravity_of_then = offered_before(
        [&](const Offer& offer) { return std::abs(offer.gravity[j] - tau) <= 1.01 * kCount; });
    const bool new_gravity = offered_lately(j, tau, &Offer::gravity, cycle);
    const bool as_before = std::abs(tau - last_[j]) <= 2.02 * kCount;
    const bool goes = arm_.state->drive_state == joint_state_t::DRIVE_DAMP &&
                      std::abs(tau) < std::abs(last_[j]) && tau * last_[j] >= 0.0;
    ASSERT_TRUE(towards || gravity_of_then || new_gravity || as_before || goes)
        << "joint " << j << " is held with " << tau << " after " << last_[j] << " in cycle "
        << cycle;
    last_[j] = tau;
    if (raw.kp == 0) return;
    const double drive_tau = arm_.robot.joints[j].drive.sign * tau;
    const double spring = 50.0 * (-12.5 + raw.p * 25.0 / 65535.0 - believed_angle(j));
    ASSERT_LE(std::abs(spring + drive_tau), kLimit + 0.1) << "cycle " << cycle;
  }

  /// Drive angle that belongs to the state published last, before this cycle's.
  double believed_angle(std::size_t j) const {
    const DriveConfig& drive = arm_.robot.joints[j].drive;
    return drive.sign * published_q_[j] + drive.offset_rad;
  }

  /// Zero, or what some command of the last cycles asked for.
  bool offered_lately(std::size_t j, double tau, std::array<double, kJoints> Offer::*field,
                      std::int64_t cycle) const {
    if (std::abs(tau) <= 1.01 * kCount) return true;
    return std::any_of(offers_.begin(), offers_.end(), [&](const Offer& offer) {
      return cycle - offer.cycle <= 4 && std::abs((offer.*field)[j] - tau) <= 1.01 * kCount;
    });
  }

  enum class Kind { kOther, kTorque, kFallback };
  const FakeArm& arm_;
  std::deque<Offer> offers_;
  std::deque<Offer> held_;
  bool was_hold_ = false;
  std::array<Kind, kJoints> before_{};
  std::array<double, kJoints> last_{};
  std::array<double, kJoints> published_q_{};
  std::array<double, kJoints> applied_{};
};

class BadDay {
 public:
  explicit BadDay(std::uint64_t seed)
      : arm(testing::test_robot(kJoints)), oracle(arm), random_(seed) {}

  void cycle() {
    disturb();
    for (FakeMotor& motor : arm.motors) {
      motor.frames.clear();
      motor.questions.clear();
    }
    arm.half_cycle();
    oracle.judge(arm.cycle);
    states.insert(arm.state->drive_state);
    faults.insert(arm.state->fault);
    if (arm.state->drive_state == joint_state_t::DRIVE_ON) ++cycles_on;
    if (!chance(away_ ? 0.98 : 0.01)) command();
    if (chance(away_ ? 0.01 : 0.0005)) away_ = !away_;
  }

  FakeArm arm;
  Oracle oracle;
  std::set<int> states;
  std::set<int> faults;
  std::set<int> verdicts;
  std::int64_t cycles_on = 0;

 private:
  bool chance(double p) { return std::uniform_real_distribution<>(0.0, 1.0)(random_) < p; }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random_);
  }
  int pick(int n) { return std::uniform_int_distribution<>(0, n - 1)(random_); }

  void disturb() {
    for (std::size_t j = 0; j < kJoints; ++j) {
      FakeMotor& motor = arm.motors[j];
      if (chance(motor.silent ? 0.3 : 0.003)) motor.silent = !motor.silent;
      if (chance(0.0003)) motor.error = pick(16);
      if (chance(0.0001)) motor.registers[21 + pick(3)] = static_cast<std::uint32_t>(random_());
      if (chance(0.002)) repair(motor);
      angle_[j] = std::clamp(angle_[j] + uniform(-4e-3, 4e-3), -2.05, 2.05);
      arm.set_angle(static_cast<int>(j), angle_[j] + (chance(0.002) ? uniform(-20, 20) : 0.0));
      arm.set_speed(static_cast<int>(j), chance(0.01) ? uniform(-40, 40) : uniform(-4, 4));
      if (chance(0.0002)) fast_ = 5;
      if (fast_ > 0) arm.set_speed(0, 9.0);
    }
    if (fast_ > 0) --fast_;
    if (chance(0.0003)) arm.driver->report_overruns();
    if (chance(0.01)) send_noise();
  }

  void repair(FakeMotor& motor) {
    motor.set_float(21, 12.5);
    motor.set_float(22, 30.0);
    motor.set_float(23, 10.0);
  }

  void send_noise() {
    CanFrame frame;
    frame.id = 0x11 + static_cast<std::uint32_t>(pick(5));
    frame.length = static_cast<std::uint8_t>(pick(9));
    frame.remote = chance(0.1);
    frame.error = chance(0.1);
    for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(pick(256));
    if (chance(0.5)) frame.data[0] = 0x11;  // looks like joint 1
    arm.motor_ends[0]->send(frame);
  }

  void command() {
    joint_command_t& c = arm.command;
    const int state = arm.state->drive_state;
    c.request = joint_command_t::REQUEST_KEEP;
    if (state == joint_state_t::DRIVE_OFF) c.request = joint_command_t::REQUEST_ON;
    if (state >= joint_state_t::DRIVE_HOLD)
      c.request = chance(0.02) ? joint_command_t::REQUEST_ACKNOWLEDGE + 0
                               : joint_command_t::REQUEST_KEEP + 0;
    if (state >= joint_state_t::DRIVE_HOLD && arm.state->fault == 0)
      c.request = joint_command_t::REQUEST_ON;
    if (chance(0.002)) c.request = joint_command_t::REQUEST_HOLD;
    for (int i = 0; i < kJoints; ++i) {
      if (state != joint_state_t::DRIVE_ON) c.tau[i] = arm.state->tau_applied[i];
      const double next = c.tau[i] + uniform(-0.45, 0.45);
      c.tau[i] = std::clamp(next, -kLimit, kLimit);
      c.tau_gravity[i] = std::clamp(c.tau_gravity[i] + uniform(-1, 1), -kLimit, kLimit);
    }
    c.state_seq = arm.state->seq;
    const joint_command_t good = c;
    for (int spoiled = pick(200); spoiled < 2; ++spoiled) spoil(c);
    offer(c);
    arm.command = good;
    if (chance(0.005)) offer(c);  // a duplicate
    if (chance(0.002)) {
      arm.command.controller = 1 + pick(8);
      offer(arm.command);
      arm.command = good;
    }
  }

  void offer(const joint_command_t& command) {
    oracle.offered(command, arm.cycle);
    verdicts.insert(arm.driver->accept(command));
  }

  double bad_number() {
    switch (pick(6)) {
      case 0:
        return std::numeric_limits<double>::quiet_NaN();
      case 1:
        return std::numeric_limits<double>::infinity();
      case 2:
        return -1e308;
      case 3:
        return uniform(-30, 30);
      case 4:
        return 5e-324;
      default:
        return std::bit_cast<double>(random_());
    }
  }

  void spoil(joint_command_t& c) {
    switch (pick(8)) {
      case 0:
        c.tau[pick(kJoints)] = bad_number();
        break;
      case 1:
        c.tau_gravity[pick(kJoints)] = bad_number();
        break;
      case 2:
        c.session = pick(50);
        break;
      case 3:
        c.controller = pick(9);
        break;
      case 4:
        c.num_joints = static_cast<std::int16_t>(pick(20));
        break;
      case 5:
        c.state_seq = arm.state->seq + pick(20) - 15;
        break;
      case 6:
        c.request = static_cast<std::int8_t>(pick(256) - 128);
        break;
      default:
        c.request = static_cast<std::int8_t>(pick(5));
        break;
    }
  }

  std::mt19937_64 random_;
  std::array<double, kJoints> angle_{1.9, 0.0, -1.9};  // two of them near a limit
  int fast_ = 0;
  bool away_ = false;
};

TEST(RandomSequenceTest, NothingForbiddenEverReachesAMotor) {
  BadDay day(20240607);
  for (int i = 0; i < 400'000; ++i) {
    day.cycle();
    if (HasFatalFailure()) return;
  }
  // The day was bad in all ways, and the arm was on for enough of it to matter.
  EXPECT_EQ(day.states.size(), 7U);
  EXPECT_EQ(day.verdicts.size(), 11U);
  EXPECT_EQ(day.faults.size(), 10U);  // all but that of the bus
  EXPECT_GT(day.cycles_on, 25'000);
  EXPECT_GT(day.oracle.torque_frames, 75'000);
  EXPECT_GT(day.oracle.hold_frames, 60'000);
}

}  // namespace
}  // namespace limber::test_random_sequence
