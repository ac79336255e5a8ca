// The emergency stop as JOINT_STATE tells of it: what it ends, and when it may be acknowledged.
#include "tests/controller/modes/supervisor_bench.h"

namespace limber::controller::test_emergency_stop_input {
namespace {

using namespace supervisor_bench;

constexpr std::int8_t kStopping[] = {State::STOP_PRESSED, State::STOP_SILENT};
constexpr char kPressed[] = "the emergency stop is pressed, or its input is silent";

class EmergencyStopInput : public SupervisorBench {
 protected:
  void states_with(std::int8_t stop, int count, std::int8_t drive_state = State::DRIVE_OFF) {
    for (int i = 0; i < count; ++i) {
      joint_state_t made = state(drive_state);
      made.emergency_stop = stop;
      supervisor_.on_state(made);
    }
  }
  void begin() {
    supervisor_ = Supervisor(1, 2);
    seq_ = -1;
  }
};

TEST_F(EmergencyStopInput, ReleasedOrAbsentItEndsNothing) {
  for (const std::int8_t stop : {State::STOP_NONE, State::STOP_RELEASED}) {
    begin();
    states_with(stop, Supervisor::kSteadyStates);
    EXPECT_EQ(supervisor_.mode(), Mode::kIdle) << int{stop};
  }
}

TEST_F(EmergencyStopInput, PressedOrSilentItEndsEveryMode) {
  for (const std::int8_t stop : kStopping) {
    begin();
    states_with(stop, 1);
    EXPECT_EQ(supervisor_.mode(), Mode::kEstop) << "BOOT";
    begin();
    to_hold();
    states_with(stop, 1, State::DRIVE_ON);
    EXPECT_EQ(supervisor_.mode(), Mode::kEstop) << "HOLD";
    EXPECT_FALSE(supervisor_.engaged());
    begin();
    to_hold();
    ASSERT_EQ(ask(Request::REQUEST_ACTIVE), "");
    states_with(stop, 1, State::DRIVE_ON);
    EXPECT_EQ(supervisor_.mode(), Mode::kEstop) << "ACTIVE";
  }
}

TEST_F(EmergencyStopInput, IsAcknowledgedOnceItIsReleased) {
  for (const std::int8_t stop : kStopping) {
    begin();
    to_hold();
    states_with(stop, 200, State::DRIVE_HOLD);
    EXPECT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), kPressed);
    EXPECT_EQ(ask(Request::REQUEST_HOLD), "not taken in ESTOP");
    EXPECT_EQ(supervisor_.mode(), Mode::kEstop);
    states_with(State::STOP_RELEASED, 1, State::DRIVE_HOLD);
    EXPECT_EQ(supervisor_.mode(), Mode::kEstop) << "latched";
    EXPECT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
    EXPECT_EQ(supervisor_.mode(), Mode::kIdle);
  }
}

}  // namespace
}  // namespace limber::controller::test_emergency_stop_input
