// The force/torque sensor in the driver's cycle: readings, their age, losses, and that the motors
// do not care.
#include <gtest/gtest.h>

#include "drivers/protocols/limber_ft.h"
#include "drivers/protocols/robotous_rft.h"
#include "tests/drivers/fake_arm.h"

namespace limber::test_tip_sensor_link {
namespace {

using testing::FakeArm;
using testing::test_robot;

Robot robot_with_ft() {
  Robot robot = test_robot(2);
  robot.has_tip_sensor = true;
  robot.tip_sensor.protocol = TipSensorProtocol::kLimberFt;
  robot.tip_sensor.command_id = 0x54;
  robot.tip_sensor.reply_ids = {0x55, 0};
  return robot;
}

/// On a classic bus of its own.
Robot robot_with_rft() {
  Robot robot = test_robot(2);
  robot.buses.push_back({"sensor", "virtual:sensor", false, 1'000'000, 5'000'000});
  robot.has_tip_sensor = true;
  robot.tip_sensor.protocol = TipSensorProtocol::kRobotousRft;
  robot.tip_sensor.bus = 1;
  robot.tip_sensor.command_id = 100;
  robot.tip_sensor.reply_ids = {1, 2};
  return robot;
}

/// Motors and a sensor that answers, or does not.
class SensedArm : public FakeArm {
 public:
  explicit SensedArm(const Robot& from, bool lockstep = false)
      : FakeArm(from, lockstep),
        sensor(memory[static_cast<std::size_t>(from.tip_sensor.bus)]->attach()) {}

  const joint_state_t& cycle_once() {
    begin();
    answer_requests();
    return end();
  }
  void begin() {
    driver->transmit(++cycle * 1'000'000, 0);
    answer();
  }
  const joint_state_t& end() {
    driver->poll();
    state = &driver->finish_cycle();
    return *state;
  }

  void answer_requests() {
    CanFrame frame;
    while (sensor->receive(std::span(&frame, 1)) == 1) {
      if (!silent) answer_one(frame);
    }
  }
  void answer_one(const CanFrame& frame) {
    const TipSensorConfig& config = robot.tip_sensor;
    std::uint8_t counter = 0;
    std::array<CanFrame, 2> halves;
    if (limber_ft::decode_request(frame, config.command_id, &counter)) {
      ASSERT_TRUE(limber_ft::encode_reply(reading, counter, config.reply_ids[0], &halves[0]));
      sensor->send(halves[0]);
    } else if (robotous_rft::decode_request(frame, config.command_id)) {
      ASSERT_TRUE(robotous_rft::encode_reply(reading, {}, config.reply_ids, &halves));
      for (int i = 0; i < halves_sent; ++i) sensor->send(halves[static_cast<std::size_t>(i)]);
    }
  }

  std::unique_ptr<CanBus> sensor;
  WrenchReading reading{{1.0, -2.0, 3.0, 0.25, -0.5, 0.75}, 0};
  bool silent = false;
  int halves_sent = 2;
};

void expect_reading(const joint_state_t& state, const WrenchReading& reading) {
  for (std::size_t i = 0; i < 6; ++i) EXPECT_DOUBLE_EQ(state.F_sensor[i], reading.F[i]);
}

class TipSensorInTheCycle : public ::testing::TestWithParam<Robot (*)()> {};
INSTANTIATE_TEST_SUITE_P(Protocols, TipSensorInTheCycle,
                         ::testing::Values(&robot_with_ft, &robot_with_rft));

TEST_P(TipSensorInTheCycle, GivesAReadingEachCycle) {
  SensedArm arm(GetParam()());
  for (int i = 0; i < 5; ++i) {
    arm.reading.F[2] = i;
    const joint_state_t& state = arm.cycle_once();
    EXPECT_EQ(state.sensor_state, int{joint_state_t::SENSOR_FRESH});
    EXPECT_EQ(state.sensor_age_cycles, 0);
    expect_reading(state, arm.reading);
  }
  EXPECT_EQ(arm.read_status().sensor_replies_lost, 0);
  EXPECT_EQ(arm.read_status().sensor_replies_invalid, 0);
}

TEST_P(TipSensorInTheCycle, SilenceIsBridgedThenAnErrorThenOver) {
  SensedArm arm(GetParam()());
  arm.cycle_once();
  arm.silent = true;
  for (int age = 1; age <= 2; ++age) {
    EXPECT_EQ(arm.cycle_once().sensor_state, int{joint_state_t::SENSOR_STALE}) << age;
    EXPECT_EQ(arm.state->sensor_age_cycles, age);
    expect_reading(*arm.state, arm.reading);
  }
  EXPECT_EQ(arm.cycle_once().sensor_state, int{joint_state_t::SENSOR_ERROR});
  EXPECT_EQ(arm.read_status().sensor_replies_lost, 3);
  arm.silent = false;
  EXPECT_EQ(arm.cycle_once().sensor_state, int{joint_state_t::SENSOR_FRESH});
}

TEST_P(TipSensorInTheCycle, NeverHeardIsAnError) {
  SensedArm arm(GetParam()());
  arm.silent = true;
  EXPECT_EQ(arm.cycle_once().sensor_state, int{joint_state_t::SENSOR_ERROR});
  EXPECT_EQ(arm.state->sensor_age_cycles, INT32_MAX);
}

TEST_P(TipSensorInTheCycle, OverloadIsAnErrorAtOnce) {
  SensedArm arm(GetParam()());
  arm.reading.overload = overload_bit(2);
  EXPECT_EQ(arm.cycle_once().sensor_state, int{joint_state_t::SENSOR_ERROR});
  EXPECT_EQ(arm.state->sensor_age_cycles, 0);
  expect_reading(*arm.state, arm.reading);
}

TEST_P(TipSensorInTheCycle, AReadingThatComesTooLateIsACycleOld) {
  SensedArm arm(GetParam()());
  arm.cycle_once();
  arm.begin();
  EXPECT_EQ(arm.end().sensor_state, int{joint_state_t::SENSOR_STALE});
  arm.reading.F[0] = 9.0;
  arm.answer_requests();  // after the state has gone out
  arm.begin();
  EXPECT_EQ(arm.end().sensor_age_cycles, 1);
  expect_reading(*arm.state, arm.reading);
  EXPECT_EQ(arm.read_status().sensor_replies_late, 1);
}

TEST_P(TipSensorInTheCycle, ALostSensorTripsNoMotor) {
  SensedArm arm(GetParam()());
  const auto cycle_with = [&arm](int request) {
    arm.cycle_once();
    arm.command.request = static_cast<std::int8_t>(request);
    arm.answer_state();
  };
  for (int i = 0; i < 200; ++i) cycle_with(joint_command_t::REQUEST_ON);
  ASSERT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_ON});
  arm.silent = true;
  for (int i = 0; i < 200; ++i) cycle_with(joint_command_t::REQUEST_ON);
  EXPECT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_ON});
  EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_NONE});
}

TEST_P(TipSensorInTheCycle, TheCycleWaitsForItUntilItIsGivenUp) {
  SensedArm arm(GetParam()());
  arm.cycle_once();
  arm.silent = true;
  for (int i = 0; i < 2; ++i) {
    arm.begin();
    arm.driver->poll();
    EXPECT_FALSE(arm.driver->complete()) << i;
    arm.end();
  }
  arm.begin();
  arm.driver->poll();
  EXPECT_TRUE(arm.driver->complete());
}

TEST(TipSensorLink, HalvesOfTwoRepliesMakeNoReading) {
  SensedArm arm(robot_with_rft());
  arm.cycle_once();
  arm.halves_sent = 1;
  EXPECT_EQ(arm.cycle_once().sensor_state, int{joint_state_t::SENSOR_STALE});
  CanFrame second;
  second.id = 2;
  second.length = 8;
  arm.begin();
  arm.sensor->send(second);
  EXPECT_EQ(arm.end().sensor_age_cycles, 2);
  EXPECT_EQ(arm.read_status().sensor_replies_invalid, 1);
}

TEST(TipSensorLink, AnAnswerToAnOlderRequestIsNotThisCycles) {
  SensedArm arm(robot_with_ft());
  arm.cycle_once();
  CanFrame old;
  arm.begin();
  ASSERT_TRUE(limber_ft::encode_reply(arm.reading, 1, 0x55, &old));  // of the first cycle
  arm.sensor->send(old);
  EXPECT_EQ(arm.end().sensor_age_cycles, 1);
  EXPECT_EQ(arm.read_status().sensor_replies_invalid, 1);
}

TEST(TipSensorLink, WithoutOneThereIsNothingOnTheBusOrInTheMessage) {
  FakeArm arm(test_robot(2));
  const std::unique_ptr<CanBus> listener = arm.memory[0]->attach();
  arm.half_cycle();
  EXPECT_EQ(arm.state->sensor_state, int{joint_state_t::SENSOR_NONE});
  EXPECT_EQ(arm.state->sensor_age_cycles, 0);
  for (const double value : arm.state->F_sensor) EXPECT_EQ(value, 0.0);
  CanFrame frame;
  int frames = 0;
  while (listener->receive(std::span(&frame, 1)) == 1) ++frames;
  EXPECT_EQ(frames, 4);  // two motors, both ways
}

TEST(TipSensorLink, StateStaysWithinOneDatagram) {
  EXPECT_LT(joint_state_t{}.getEncodedSize(), 1400);
}

}  // namespace
}  // namespace limber::test_tip_sensor_link
