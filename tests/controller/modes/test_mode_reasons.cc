// Which REASON_* each row of the mode table keeps, by rules written down independently of it.
#include <gtest/gtest.h>

#include <map>

#include "controller/modes/mode_table.h"

namespace limber::controller::test_mode_reasons {
namespace {

using Status = controller_status_t;

const std::map<Event, int> kReasons = {
    {Event::kStateLost, +Status::REASON_STATE_LOST},
    {Event::kStateInvalid, +Status::REASON_STATE_INVALID},
    {Event::kDriverFault, +Status::REASON_DRIVER_FAULT},
    {Event::kNewSession, +Status::REASON_SESSION_CHANGED},
    {Event::kTorqueInvalid, +Status::REASON_TORQUE_INVALID},
    {Event::kDriveNotOn, +Status::REASON_DRIVE_NOT_ON},
    {Event::kStrayed, +Status::REASON_STRAYED},
    {Event::kOverdriven, +Status::REASON_OVERDRIVEN},
    {Event::kEncoderStopped, +Status::REASON_ENCODER_STOPPED},
    {Event::kEnergy, +Status::REASON_ENERGY},
    {Event::kClientSilent, +Status::REASON_CLIENT_SILENT},
};

/// What went wrong is kept wherever it ends something; INIT has nothing to end. A stop is kept
/// where it ends a motion. Nothing else is a reason.
int expected(const Transition& t) {
  if (const auto found = kReasons.find(t.event); found != kReasons.end())
    return t.from == Mode::kInit ? +Status::REASON_NONE : found->second;
  const bool moving = t.from == Mode::kActive || t.from == Mode::kSoftStop;
  return t.event == Event::kRequestStop && moving ? +Status::REASON_STOP_REQUESTED
                                                  : +Status::REASON_NONE;
}

TEST(ModeReasons, EachRowKeepsTheReasonOfItsEvent) {
  for (const Transition& t : transitions()) {
    EXPECT_EQ(int{t.reason}, expected(t))
        << "mode " << static_cast<int>(t.from) << ", event " << static_cast<int>(t.event);
  }
}

}  // namespace
}  // namespace limber::controller::test_mode_reasons
