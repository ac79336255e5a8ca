// What one motor reports against itself, and what is forgotten when it begins anew.
#include <gtest/gtest.h>

#include "drivers/drive/feedback_watch.h"
#include "tests/drivers/drive/damiao_reply.h"

namespace limber::test_feedback_watch {
namespace {

using testing::answer;
using testing::DamiaoReply;

constexpr double kPeriod_s = 1e-3;
constexpr DamiaoReply kStanding{testing::kEnabled, 0.0, 0.0, 0.0};
constexpr DamiaoReply kPulling{testing::kEnabled, 0.0, 0.0, 9.0};   // commanded: 0
constexpr DamiaoReply kRunning{testing::kEnabled, 0.0, 15.0, 0.0};  // and yet it stands

struct Bench {
  explicit Bench(const JointConfig& joint = testing::test_robot(1).joints[0])
      : link(joint, true, kPeriod_s, 2), watch(link) {}

  void report(const DamiaoReply& reply, double seconds) {
    for (const double end_s = time_s + seconds; time_s < end_s; time_s += kPeriod_s) {
      link.torque(0.0);
      answer(&link, reply);
      watch.add(link, time_s);
    }
  }

  JointLink link;
  FeedbackWatch watch;
  double time_s = 100.0;
};

TEST(FeedbackWatchTest, NamesWhatContradicts) {
  Bench standing, pulling, running;
  standing.report(kStanding, 0.5);
  EXPECT_EQ(standing.watch.found(), Contradiction::kNone);
  pulling.report(kPulling, 0.05);
  EXPECT_EQ(pulling.watch.found(), Contradiction::kNone) << "not for long enough";
  pulling.report(kPulling, 0.1);
  EXPECT_EQ(pulling.watch.found(), Contradiction::kTorque);
  running.report(kRunning, 0.2);
  EXPECT_EQ(running.watch.found(), Contradiction::kVelocity);
}

TEST(FeedbackWatchTest, AResetForgetsBoth) {
  for (const DamiaoReply& reply : {kPulling, kRunning}) {
    Bench bench;
    bench.report(reply, 0.2);
    ASSERT_NE(bench.watch.found(), Contradiction::kNone);
    bench.watch.reset();
    EXPECT_EQ(bench.watch.found(), Contradiction::kNone);
  }
}

// The first report has no time before it that could count.
TEST(FeedbackWatchTest, TheTimeWithoutPowerDoesNotCount) {
  Bench bench;
  bench.report(kPulling, 0.01);
  bench.watch.reset();
  bench.time_s += 10.0;
  bench.report(kPulling, 0.01);
  EXPECT_EQ(bench.watch.found(), Contradiction::kNone);
}

TEST(FeedbackWatchTest, ASensorBehindTheMotorMeasuresWhateverActs) {
  JointConfig joint = testing::test_robot(1).joints[0];
  joint.torque_sensor.present = true;
  Bench bench(joint);
  bench.report(kPulling, 0.5);
  EXPECT_EQ(bench.watch.found(), Contradiction::kNone);
}

}  // namespace
}  // namespace limber::test_feedback_watch
