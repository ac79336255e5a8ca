// Target streams at the controller: what is taken, dropped and refused, and that no torque jumps
// whatever follows on whatever.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/controller/rig.h"
#include "tools/allocations/allocations.h"

namespace limber::test_target_stream {
namespace {

using limber::testing::kClient;
using limber::testing::Rig;
using Status = controller_status_t;
using Stream = target_stream_t;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Stream stream_of(const Rig& rig, std::int8_t kind) {
  Stream stream{};
  stream.client = kClient;
  stream.t0_ns = rig.state.time_ns;
  stream.kind = kind;
  stream.num_joints = static_cast<std::int8_t>(rig.state.num_joints);
  stream.num_knots = 1;
  return stream;
}

/// One knot a joint angle `away` from where the joints are.
Stream joints(const Rig& rig, double away, double delay_s = 0.05) {
  Stream stream = stream_of(rig, Stream::KIND_JOINTS);
  stream.delay_s = static_cast<float>(delay_s);
  for (int j = 0; j < stream.num_joints; ++j)
    stream.value[0][j] = static_cast<float>(rig.state.q[j] + away);
  return stream;
}

Stream pose(const Rig& rig, double away_m) {
  Stream stream = stream_of(rig, Stream::KIND_POSE);
  stream.delay_s = 0.15F;
  const Status& status = rig.controller.status();
  for (int i = 0; i < 3; ++i) stream.value[0][i] = static_cast<float>(status.p_BT[i] + away_m);
  for (int i = 0; i < 4; ++i) stream.value[0][3 + i] = static_cast<float>(status.quat_BT[i]);
  return stream;
}

Stream twist(const Rig& rig, double vx) {
  Stream stream = stream_of(rig, Stream::KIND_TWIST);
  stream.value[0][0] = static_cast<float>(vx);
  return stream;
}

void select(Rig* rig, const std::string& law) {
  compliance_gains_t gains = rig->gains();
  gains.law = law;
  gains.contact = compliance_gains_t::CONTACT_JOINT_TORQUE;
  ASSERT_EQ(rig->controller.on_gains(gains), nullptr);
}

TEST(TargetStream, IsFollowedByLawsOfBothKinds) {
  for (const char* law : {"joint_impedance", "cartesian_impedance"}) {
    Rig rig(limber::testing::seven_joint_arm());
    rig.to_active();
    select(&rig, law);
    rig.run(0.3);
    Stream stream = joints(rig, 0.0, 0.06);
    const double q0 = rig.state.q[3];
    for (int message = 0; message < 60; ++message) {  // 0.2 rad/s at 30 Hz
      stream.t0_ns = rig.state.time_ns;
      stream.value[0][3] = static_cast<float>(q0 + 0.2 * message / 30.0);
      ASSERT_EQ(rig.controller.on_stream(stream), nullptr) << law;
      rig.run(1.0 / 30.0);
    }
    EXPECT_EQ(rig.controller.status().stream, +Status::STREAM_RUNNING);
    EXPECT_EQ(rig.controller.status().stream_taken, 60);
    EXPECT_NEAR(rig.state.q[3], q0 + 0.2 * (2.0 - 0.06), 0.04) << law;
    EXPECT_EQ(rig.limits() & Status::LIMIT_STREAM, 0) << law;
  }
}

TEST(TargetStream, RestsWithoutKnotsAndGoesOnWithoutARequest) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  ASSERT_EQ(rig.controller.on_stream(pose(rig, 0.03)), nullptr);
  rig.run(1.0);
  EXPECT_EQ(rig.controller.status().stream, +Status::STREAM_WAITING);
  EXPECT_EQ(rig.controller.status().stream_starved, 1);
  EXPECT_LT(rig.controller.status().stream_margin_s, -0.8F);
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
  ASSERT_EQ(rig.controller.on_stream(pose(rig, 0.01)), nullptr);
  rig.run(0.02);
  EXPECT_EQ(rig.controller.status().stream, +Status::STREAM_RUNNING);
}

TEST(TargetStream, EndsInHoldWhenItsTimeIsOver) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  Stream stream = joints(rig, 0.02);
  stream.valid_for_s = 0.5F;  // after the last knot, which acts 0.05 s from now
  ASSERT_EQ(rig.controller.on_stream(stream), nullptr);
  rig.run(0.54);
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
  rig.run(0.5);
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
  EXPECT_EQ(rig.controller.status().reason, +Status::REASON_CLIENT_SILENT);
}

TEST(TargetStream, CountsWhatIsLateAndDropsWhatIsTooOld) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  Stream late = joints(rig, 0.0);
  late.t0_ns -= 80'000'000;  // with its delay 30 ms ago
  ASSERT_EQ(rig.controller.on_stream(late), nullptr);
  Stream stale = joints(rig, 0.3);
  stale.t0_ns -= 200'000'000;  // 150 ms ago
  ASSERT_EQ(rig.controller.on_stream(stale), nullptr);
  rig.controller.count_stale_stream();  // out of order: the desk's
  rig.step();
  EXPECT_EQ(rig.controller.status().stream_taken, 1);
  EXPECT_EQ(rig.controller.status().stream_late, 1);
  EXPECT_EQ(rig.controller.status().stream_stale, 2);
}

TEST(TargetStream, IsRefusedWithTheReason) {
  Rig rig(limber::testing::seven_joint_arm());
  const auto refused = [&](const std::function<void(Stream*)>& change, const char* words,
                           std::int8_t code) {
    Stream stream = pose(rig, 0.0);
    change(&stream);
    const Refusal refusal = rig.controller.on_stream(stream);
    ASSERT_NE(refusal, nullptr) << words;
    EXPECT_NE(std::string(refusal.reason).find(words), std::string::npos) << refusal.reason;
    EXPECT_EQ(refusal.code, code) << words;
  };
  using Answer = request_answer_t;
  rig.to_hold();
  refused([](Stream*) {}, "in ACTIVE only", Answer::REFUSED_MODE);
  rig.to_active();
  refused([](Stream* s) { s->client = 8; }, "lease", Answer::REFUSED_LEASE);
  refused([](Stream* s) { s->num_joints = 6; }, "num_joints", Answer::REFUSED_MALFORMED);
  refused([](Stream* s) { s->kind = 3; }, "kind is none", Answer::REFUSED_MALFORMED);
  refused([](Stream* s) { s->num_knots = 0; }, "num_knots", Answer::REFUSED_MALFORMED);
  refused([](Stream* s) { s->num_knots = 17; }, "num_knots", Answer::REFUSED_MALFORMED);
  refused([](Stream* s) { s->num_knots = 2; }, "dt_s must rise", Answer::REFUSED_MALFORMED);
  refused([](Stream* s) { s->dt_s[0] = kNaN; }, "dt_s must rise", Answer::REFUSED_MALFORMED);
  refused([](Stream* s) { s->value[0][2] = kNaN; }, "not finite", Answer::REFUSED_MALFORMED);
  refused([](Stream* s) { s->value[0][3] = 2.0F; }, "unit quaternion", Answer::REFUSED_MALFORMED);
  refused([](Stream* s) { s->value[0][0] = 11.0F; }, "10 m", Answer::REFUSED_GOAL_LIMIT);
  refused(
      [](Stream* s) {
        s->kind = Stream::KIND_TWIST;
        s->value[0][0] = 1.1F;
      },
      "1 m/s", Answer::REFUSED_GOAL_LIMIT);
  refused(
      [](Stream* s) {
        s->kind = Stream::KIND_JOINTS;
        s->value[0][0] = 1e6F;
      },
      "1000 rad", Answer::REFUSED_GOAL_LIMIT);
  refused([](Stream* s) { s->delay_s = 3.0F; }, "delay_s", Answer::REFUSED_GOAL_LIMIT);
  refused([](Stream* s) { s->valid_for_s = 601.0F; }, "valid_for_s", Answer::REFUSED_GOAL_LIMIT);
  refused([](Stream* s) { s->stiffness_scale = 1.1F; }, "stiffness_scale",
          Answer::REFUSED_GOAL_LIMIT);
  refused([](Stream* s) { s->F_ff[1] = 300.0F; }, "F_ff", Answer::REFUSED_GOAL_LIMIT);
  refused([](Stream* s) { s->t0_ns += 6'000'000'000; }, "5 s ahead", Answer::REFUSED_GOAL_LIMIT);
  refused([](Stream* s) { s->t0_ns = std::numeric_limits<std::int64_t>::max(); }, "5 s ahead",
          Answer::REFUSED_GOAL_LIMIT);
  refused([](Stream* s) { s->t0_ns = -2; }, "t0_ns", Answer::REFUSED_MALFORMED);
  refused(
      [](Stream* s) {
        s->num_knots = 2;
        s->dt_s[1] = 0.1F;
        s->value[1][3] = s->value[0][4];  // half a turn from knot to knot
        s->value[1][4] = s->value[0][3];
        s->value[1][5] = -s->value[0][6];
        s->value[1][6] = s->value[0][5];
      },
      "2 rad apart", Answer::REFUSED_GOAL_LIMIT);
  select(&rig, "gravity_compensation");
  refused([](Stream*) {}, "follows no goal", Answer::REFUSED_GOAL_KIND);
  rig.step();
  EXPECT_EQ(rig.controller.status().stream_refused, 22);
  EXPECT_EQ(rig.controller.status().stream_taken, 0);
}

TEST(TargetStream, KnotsBeyondAJointsEndStopThereAndAreFlagged) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  select(&rig, "joint_impedance");
  rig.run(0.2);
  Stream stream = joints(rig, 0.0);
  stream.value[0][0] = 100.0F;
  ASSERT_EQ(rig.controller.on_stream(stream), nullptr);
  rig.run(8.0);
  EXPECT_NE(rig.limits() & Status::LIMIT_STREAM, 0);
  EXPECT_LE(rig.state.q[0], rig.robot.robot.joints[0].position_max + 1e-3);
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
}

TEST(TargetStream, ScalesTheStiffnessOfTheLaw) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  const float before = rig.controller.status().K_x[0][0];
  Stream stream = pose(rig, 0.0);
  stream.stiffness_scale = 0.25F;
  ASSERT_EQ(rig.controller.on_stream(stream), nullptr);
  rig.run(0.2);  // at 2 a second
  EXPECT_NEAR(rig.controller.status().K_x[0][0], 0.6F * before, 0.01F * before);
  rig.run(0.5);
  EXPECT_NEAR(rig.controller.status().K_x[0][0], 0.25F * before, 1e-3F * before);
  compliance_gains_t gains = rig.gains();  // new gains act as they are
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  rig.run(0.6);
  EXPECT_NEAR(rig.controller.status().K_x[0][0], before, 1e-3F * before);
}

struct Action {
  const char* name;
  std::function<void(Rig*)> act;
};

std::vector<Action> actions() {
  const auto goal = [](Rig* rig, std::int8_t kind, double x) {
    compliance_goal_t message = rig->goal();
    message.kind = kind;
    message.offset[0] = x;
    message.duration_s = 0.3;
    ASSERT_EQ(rig->controller.on_goal(message), nullptr);
  };
  return {
      {"joints", [](Rig* r) { ASSERT_EQ(r->controller.on_stream(joints(*r, 0.05)), nullptr); }},
      // The elbow alone: the tip's way is far from a singular pose, near which the null space
      // turns.
      {"far joints",
       [](Rig* r) {
         Stream stream = joints(*r, 0.0, 0.02);
         stream.value[0][3] -= 0.8F;
         ASSERT_EQ(r->controller.on_stream(stream), nullptr);
       }},
      {"pose", [](Rig* r) { ASSERT_EQ(r->controller.on_stream(pose(*r, 0.02)), nullptr); }},
      {"far pose", [](Rig* r) { ASSERT_EQ(r->controller.on_stream(pose(*r, -0.1)), nullptr); }},
      {"twist", [](Rig* r) { ASSERT_EQ(r->controller.on_stream(twist(*r, 0.2)), nullptr); }},
      {"chunk",
       [](Rig* r) {
         Stream chunk = pose(*r, 0.0);
         chunk.num_knots = 16;
         chunk.stiffness_scale = 0.5F;
         chunk.F_ff[2] = 5.0F;
         for (int k = 0; k < 16; ++k) {
           chunk.dt_s[k] = 0.04F * static_cast<float>(k);
           for (int i = 0; i < 7; ++i) chunk.value[k][i] = chunk.value[0][i];
           chunk.value[k][1] += 0.01F * std::sin(0.5F * static_cast<float>(k));
         }
         if (r->controller.on_stream(chunk) == nullptr) return;
         chunk.F_ff[2] = 0.0F;  // which a law for the joints does not exert
         ASSERT_EQ(r->controller.on_stream(chunk), nullptr);
       }},
      {"goal", [=](Rig* r) { goal(r, compliance_goal_t::GOAL_OFFSET, 0.03); }},
      {"wrench", [=](Rig* r) { goal(r, compliance_goal_t::GOAL_WRENCH, 0.0); }},
      {"joint law", [](Rig* r) { select(r, "joint_impedance"); }},
      {"tip law", [](Rig* r) { select(r, "cartesian_impedance"); }},
      {"push", [](Rig* r) { r->plant.F_ext[1] = r->plant.F_ext[1] > 0.0 ? 0.0 : 10.0; }},
      {"expiry", [](Rig* r) { r->run(0.6); }},
      {"stop",
       [](Rig* r) {
         ASSERT_EQ(r->request(mode_request_t::REQUEST_STOP), nullptr);
         r->run(0.4);
         ASSERT_EQ(r->request(mode_request_t::REQUEST_ACTIVE), nullptr);
       }},
  };
}

// Every ordered pair, 80 ms apart, under a law of each kind: steps stay within what the gate lets
// pass; but for targets far away below the least of the joints' limits, so that no limiter acts.
TEST(TargetStream, NoTorqueJumpsOverAllPairs) {
  const LoadedRobot arm = limber::testing::seven_joint_arm();
  for (const char* law : {"cartesian_impedance", "joint_impedance"}) {
    for (const Action& first : actions()) {
      for (const Action& second : actions()) {
        Rig rig(arm);
        rig.viscous = VectorJ::Constant(7, 0.2);
        rig.to_active();
        select(&rig, law);
        rig.run(0.3);
        rig.clear_jumps();
        first.act(&rig);
        rig.run(0.08);
        second.act(&rig);
        rig.run(0.4);
        // Then the goal may move as fast as it may: far away, or (by inverse kinematics) at the
        // joints.
        const std::string pair = std::string(first.name) + ", " + second.name;
        const bool fast = pair.find("far") != std::string::npos || law[0] == 'j';
        EXPECT_LT(rig.jump(), fast ? 1.0 + 1e-9 : 0.75) << law << ": " << pair;
        EXPECT_TRUE(rig.tau().allFinite());
        EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE) << first.name << ", " << second.name;
        if (HasFailure()) return;
      }
    }
  }
}

// Whatever bytes come: no torque that is not finite or beyond its limits, no allocation.
TEST(TargetStream, AnyMessagesAtAnyRate) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto any = [&](double scale) {
    const double pick = uniform(random);
    if (pick > 0.98) return static_cast<double>(kNaN);
    if (pick > 0.97) return 1e30;
    return scale * uniform(random);
  };
  const std::int64_t before = allocations();
  int taken = 0;
  for (int cycle = 0; cycle < 20'000; ++cycle) {
    const int messages = cycle % 7 == 0 ? 10 : 0;  // floods of 10 kHz
    for (int i = 0; i < messages; ++i) {
      Stream stream = stream_of(rig, static_cast<std::int8_t>(random() % 4));
      stream.t0_ns += static_cast<std::int64_t>(any(2e8));
      if (uniform(random) > 0.98) stream.t0_ns = static_cast<std::int64_t>(random()) << 31;
      stream.num_knots = static_cast<std::int8_t>(random() % 18);
      stream.delay_s = static_cast<float>(std::abs(any(0.2)));
      double t = 0.0;
      for (int k = 0; k < 16; ++k) {
        stream.dt_s[k] = static_cast<float>(t);
        t += 0.1 * std::abs(uniform(random)) + 0.0005;
        for (int c = 0; c < 16; ++c) stream.value[k][c] = static_cast<float>(uniform(random));
        if (stream.kind == Stream::KIND_POSE) {
          double norm = 0.0;
          for (int c = 3; c < 7; ++c) norm += std::pow(stream.value[0][c], 2);
          for (int c = 3; c < 7; ++c)
            stream.value[k][c] = stream.value[0][c] / static_cast<float>(std::sqrt(norm));
        }
      }
      if (uniform(random) > 0.9)
        stream.value[random() % 16][random() % 16] = static_cast<float>(any(1.0));
      taken += rig.controller.on_stream(stream) == nullptr;
    }
    rig.step();
    ASSERT_TRUE(rig.tau().allFinite()) << cycle;
    ASSERT_EQ(rig.mode(), +Status::MODE_ACTIVE)
        << cycle << " reason " << int{rig.controller.status().reason} << " joint "
        << int{rig.controller.status().reason_joint};
    ASSERT_LE(rig.jump(), 1.0 + 1e-9) << cycle;
  }
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(taken, 1000);
  EXPECT_EQ(rig.controller.status().stream_taken + rig.controller.status().stream_stale, taken);
}

TEST(TorqueOverlay, IsAddedBoundedAndFades) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  rig.run(0.5);
  torque_overlay_t overlay{};
  overlay.client = kClient;
  overlay.num_joints = 7;
  overlay.valid_for_s = 0.02F;
  overlay.tau[5] = 1.0F;
  const VectorJ before = rig.tau();
  rig.clear_jumps();
  ASSERT_EQ(rig.controller.on_overlay(overlay), nullptr);
  rig.run(0.004);
  EXPECT_NEAR(rig.tau()[5] - before[5], 1.0, 0.2);
  rig.run(0.05);
  EXPECT_LE(rig.jump(), 1.0 + 1e-9);
  EXPECT_EQ(rig.controller.status().overlays_taken, 1);
  EXPECT_EQ(rig.controller.status().overlays_expired, 1);
  overlay.tau[5] = static_cast<float>(rig.robot.robot.joints[5].torque_limit_Nm * 0.34);
  EXPECT_NE(rig.controller.on_overlay(overlay), nullptr);
  overlay.tau[5] = kNaN;
  EXPECT_NE(rig.controller.on_overlay(overlay), nullptr);
  overlay.tau[5] = 0.0F;
  overlay.valid_for_s = 0.051F;
  EXPECT_NE(rig.controller.on_overlay(overlay), nullptr);
  rig.request(mode_request_t::REQUEST_HOLD);
  overlay.valid_for_s = 0.01F;
  EXPECT_NE(rig.controller.on_overlay(overlay), nullptr);
}

}  // namespace
}  // namespace limber::test_target_stream
