// The goal along a target stream: smooth whatever comes, and as close and as calm as published
// simulations of such streams are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "controller/goals/stream/stream_motion.h"
#include "controller/model/rotation.h"

namespace limber::controller {
namespace {

constexpr double kStep_s = 1e-3;
constexpr std::int64_t kStep_ns = 1'000'000;

VectorJ one(double x) { return VectorJ::Constant(1, x); }

StreamBounds<VectorJ> wide() { return {one(1.0), one(2.0), one(1e3), one(25.0)}; }

std::int64_t ns(double s) { return std::llround(1e9 * s); }

/// Sum of sines of 0.13 to 1.6 Hz, peak speed 1 rad/s, rms jerk about 14 rad/s^3.
class Signal {
 public:
  explicit Signal(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    for (double& p : phase_) p = phase(random);
    double fastest = 0.0;
    for (double t = 0.0; t < 24.0; t += kStep_s)
      fastest = std::max(fastest, std::abs((at(t + 1e-5) - at(t - 1e-5)) / 2e-5));
    scale_ = 1.0 / fastest;
  }
  double at(double t) const {
    double x = 0.0;
    for (std::size_t i = 0; i < kHz.size(); ++i)
      x += scale_ * kAmplitude[i] * std::sin(2.0 * std::numbers::pi * kHz[i] * t + phase_[i]);
    return x;
  }

 private:
  static constexpr std::array<double, 5> kHz{0.13, 0.31, 0.57, 0.9, 1.6};
  static constexpr std::array<double, 5> kAmplitude{0.3, 0.15, 0.08, 0.055, 0.021};
  std::array<double, 5> phase_{};
  double scale_ = 1.0;
};

struct Link {
  double period_s, jitter_s, delay_s;
  double loss = 0.1;
  double transport_s = 0.01;
};

struct Message {
  double arrives_s;
  std::vector<Knot<JointSpace>> knots;
};

struct Figures {
  double lag_ms, rms_mrad, peak_a, rms_jerk;
};

/// Follows `messages`, in the order of arrival, for 24 s.
std::vector<JointSpace::Point> follow(std::vector<Message> messages, double start) {
  std::stable_sort(messages.begin(), messages.end(),
                   [](const Message& a, const Message& b) { return a.arrives_s < b.arrives_s; });
  StreamMotion<JointSpace> motion(wide());
  motion.reset(JointSpace::at_rest(one(start)), -kStep_ns);
  std::vector<JointSpace::Point> goal;
  std::size_t next = 0;
  for (int i = 0; i < 24'000; ++i) {
    for (; next < messages.size() && messages[next].arrives_s <= kStep_s * i; ++next)
      EXPECT_TRUE(motion.take(messages[next].knots));
    if (motion.active()) motion.advance(i * kStep_ns, kStep_s, one(1e9), one(1e9));
    goal.push_back(motion.goal());
  }
  return goal;
}

Figures figures(const std::vector<JointSpace::Point>& goal, const Signal& signal) {
  constexpr int kFrom = 2000, kTo = 23'000;
  Figures best{0.0, 1e9, 0.0, 0.0};
  for (int lag = 0; lag < 120; ++lag) {
    double sum = 0.0;
    for (int i = kFrom; i < kTo; ++i) {
      const double error = goal[static_cast<std::size_t>(i)].x[0] - signal.at(kStep_s * (i - lag));
      sum += error * error;
    }
    const double rms = 1e3 * std::sqrt(sum / (kTo - kFrom));
    if (rms < best.rms_mrad) best = {1.0 * lag, rms, 0.0, 0.0};
  }
  double sum = 0.0;
  for (int i = kFrom; i < kTo; ++i) {
    const double a = goal[static_cast<std::size_t>(i)].a[0];
    const double jerk = (a - goal[static_cast<std::size_t>(i - 1)].a[0]) / kStep_s;
    best.peak_a = std::max(best.peak_a, std::abs(a));
    sum += jerk * jerk;
  }
  best.rms_jerk = std::sqrt(sum / (kTo - kFrom));
  return best;
}

/// Single targets; those that a newer one has overtaken are dropped by RequestGuard.
std::vector<Message> single_targets(const Signal& signal, const Link& link) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Message> messages;
  double newest_s = -1.0;
  for (double t = 0.0; t < 24.0; t += link.period_s) {
    const bool lost = uniform(random) < link.loss;
    const double arrives_s = t + link.transport_s + uniform(random) * link.jitter_s;
    if (lost || arrives_s < newest_s) continue;
    newest_s = arrives_s;
    messages.push_back({arrives_s, {{ns(t + link.delay_s), one(signal.at(t))}}});
  }
  return messages;
}

Figures of_targets(double hz, double jitter_s, double delay_s) {
  const Signal signal(1);
  const Link link{1.0 / hz, jitter_s, delay_s};
  return figures(follow(single_targets(signal, link), signal.at(0.0)), signal);
}

TEST(StreamMotion, SingleTargetsInterpolated) {
  const Figures f = of_targets(30.0, 0.02, 1.0 / 30.0 + 0.028);
  EXPECT_LE(f.lag_ms, 64.0);
  EXPECT_LE(f.rms_mrad, 1.1);
  EXPECT_LE(f.rms_jerk, 45.0);
  EXPECT_LE(f.peak_a, 10.0);
}

TEST(StreamMotion, SingleTargetsExtrapolated) {
  const Figures f = of_targets(30.0, 0.02, 0.03);
  EXPECT_LE(f.lag_ms, 40.0);
  EXPECT_LE(f.rms_mrad, 3.0);
  EXPECT_LE(f.rms_jerk, 60.0);
  EXPECT_LE(f.peak_a, 12.0);
}

TEST(StreamMotion, FiftyHertz) {
  const Figures f = of_targets(50.0, 0.012, 0.02 + 0.02);
  EXPECT_LE(f.lag_ms, 44.0);
  EXPECT_LE(f.rms_mrad, 1.0);
  EXPECT_LE(f.rms_jerk, 45.0);
}

// A message of a policy's chunk comes late, but its knots lie ahead.
TEST(StreamMotion, ChunksOfOnePolicyHaveNoLagOfTheirOwn) {
  const Signal signal(1);
  std::vector<Message> messages;
  for (double t = 0.0; t < 24.0; t += 0.5) {
    std::vector<Knot<JointSpace>> chunk;
    for (int k = 0; k < 50; ++k) chunk.push_back({ns(t + 0.02 * k), one(signal.at(t + 0.02 * k))});
    for (std::size_t part = 0; part < 50; part += 16) {  // as the message holds
      const std::size_t end = std::min<std::size_t>(part + 16, 50);
      messages.push_back({t + 0.1,
                          {chunk.begin() + static_cast<std::ptrdiff_t>(part),
                           chunk.begin() + static_cast<std::ptrdiff_t>(end)}});
    }
  }
  const Figures f = figures(follow(messages, signal.at(0.0)), signal);
  EXPECT_EQ(f.lag_ms, 0.0);
  EXPECT_LE(f.rms_mrad, 0.1);
  EXPECT_LE(f.rms_jerk, 16.0);
}

// Chunks of 16, every 8, each off by up to 20 mrad, 10 % lost: cutting over would step the goal.
TEST(StreamMotion, ChunksThatDisagreeAreFaded) {
  const Signal signal(1);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double h = 1.0 / 30.0;
  std::vector<Message> messages;
  for (int start = 0; h * start < 24.0; start += 8) {
    const double off = 0.04 * uniform(random) - 0.02;
    if (uniform(random) < 0.1) continue;
    Message message{h * start + 0.1, {}};
    for (int k = start; k < start + 16; ++k)
      message.knots.push_back({ns(h * k), one(signal.at(h * k) + off)});
    messages.push_back(message);
  }
  const Figures f = figures(follow(messages, signal.at(0.0)), signal);
  EXPECT_LE(f.peak_a, 18.0);
  EXPECT_LE(f.rms_jerk, 99.0);
  EXPECT_LE(f.rms_mrad, 26.0);
}

// Position, velocity and acceleration go with each other, and only bounds make the latter step.
TEST(StreamMotion, NothingJumpsWhateverComes) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  StreamBounds<VectorJ> bounds = wide();
  bounds.v_max = one(2.0);
  StreamMotion<JointSpace> motion(bounds);
  motion.reset(JointSpace::at_rest(one(0.0)), -kStep_ns);
  JointSpace::Point last = motion.goal();
  int bounded = 0;
  for (int i = 0; i < 200'000; ++i) {
    if (uniform(random) < 0.03) {
      std::vector<Knot<JointSpace>> knots;
      std::int64_t time_ns = i * kStep_ns + ns(0.3 * uniform(random) - 0.1);
      const int count = 1 + static_cast<int>(16.0 * uniform(random));
      for (int k = 0; k < count; ++k) {
        knots.push_back({time_ns, one(2.0 * uniform(random) - 1.0)});
        time_ns += ns(0.001 + 0.1 * uniform(random));
      }
      ASSERT_TRUE(motion.take(knots));
    }
    if (!motion.active()) continue;
    motion.advance(i * kStep_ns, kStep_s, one(1e9), one(1e9));
    const JointSpace::Point& now = motion.goal();
    bounded += motion.bounded();
    ASSERT_LE(std::abs(now.v[0]), 2.0 + 1e-9) << i;
    ASSERT_LE(std::abs(now.a[0]), 25.0 + 1e-9) << i;
    ASSERT_LE(std::abs(now.v[0] - last.v[0]), 25.0 * kStep_s + 1e-6) << i;
    ASSERT_NEAR(now.x[0], last.x[0] + 0.5 * kStep_s * (now.v[0] + last.v[0]), 3e-6) << i;
    last = now;
  }
  EXPECT_GT(bounded, 1000);  // the bounds have been tried
}

// Out of knots: to rest within 0.25 s, half of v T further.
TEST(StreamMotion, BrakesWhenKnotsRunOut) {
  StreamMotion<JointSpace> motion(wide());
  motion.reset(JointSpace::at_rest(one(0.0)), -kStep_ns);
  std::vector<Knot<JointSpace>> ramp;  // 0.4 rad/s from the beginning on
  for (int k = 0; k < 16; ++k) ramp.push_back({ns(0.05 * k), one(0.02 * k)});
  ASSERT_TRUE(motion.take(ramp));
  for (int i = 0; i <= 1200; ++i) motion.advance(i * kStep_ns, kStep_s, one(1e9), one(1e9));
  EXPECT_NEAR(motion.goal().x[0], 0.30 + 0.5 * 0.4 * 0.25, 1e-9);
  EXPECT_NEAR(motion.goal().v[0], 0.0, 1e-12);
  EXPECT_NEAR(motion.goal().a[0], 0.0, 1e-12);
}

TEST(StreamMotion, RepeatedMessagesChangeNothing) {
  const Signal signal(1);
  std::vector<Message> once = single_targets(signal, {1.0 / 30.0, 0.0, 0.06});
  std::vector<Message> twice;
  for (const Message& message : once) {
    twice.push_back(message);
    twice.push_back(message);
  }
  const auto a = follow(once, 0.0), b = follow(twice, 0.0);
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i].x - b[i].x).norm());
  EXPECT_LT(most, 1e-12);
}

TEST(StreamMotion, TooManyKnotsAreRefusedAndChangeNothing) {
  StreamMotion<JointSpace> motion(wide());
  motion.reset(JointSpace::at_rest(one(0.0)), 0);
  std::int64_t time_ns = 0;
  int taken = 0;
  for (bool room = true; room && taken < 1000;) {
    std::vector<Knot<JointSpace>> knots;
    for (int k = 0; k < 16; ++k) knots.push_back({time_ns += 2 * kStep_ns, one(0.1)});
    room = motion.take(knots);
    taken += room ? 16 : 0;
  }
  EXPECT_EQ(taken, KnotPath<JointSpace>::kMost);
  EXPECT_EQ(motion.last_ns(), taken * 2 * kStep_ns);
}

// The tip turns by more than half a turn in all; its twist is the rate of its pose.
TEST(StreamMotion, TheTipTurnsSmoothly) {
  Vector6 v_fade, a_fade, v_max, a_max;
  v_fade << 0.25, 0.25, 0.25, 1.0, 1.0, 1.0;
  a_fade.setConstant(2.0);
  v_max << 1.0, 1.0, 1.0, 4.0, 4.0, 4.0;
  a_max << 10.0, 10.0, 10.0, 25.0, 25.0, 25.0;
  StreamMotion<TipSpace> motion({v_fade, a_fade, v_max, a_max});
  const Pose start{{0.4, 0.0, 0.3},
                   Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()))};
  motion.reset(TipSpace::at_rest(start), -kStep_ns);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double h = 1.0 / 30.0;
  TipSpace::Point last = motion.goal();
  double turned = 0.0, jump_a = 0.0;
  bool bounded = false;
  for (int i = 0; i < 8000; ++i) {
    const double t = kStep_s * i;
    if (i % 33 == 0) {
      const Eigen::Vector3d axis(std::sin(0.7 * t), std::cos(0.5 * t), 1.0);
      Knot<TipSpace> knot{
          ns(t + 0.02 + h),
          {start.p + 0.1 * Eigen::Vector3d(std::sin(t), std::cos(t) - 1.0, 0.2 * t),
           Eigen::Quaterniond(Eigen::AngleAxisd(1.1 * t, axis.normalized())) * start.Q}};
      knot.x.p += 0.001 * Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
      ASSERT_TRUE(motion.take(std::span(&knot, 1)));
    }
    motion.advance(i * kStep_ns, kStep_s, v_max, v_max);
    const TipSpace::Point& now = motion.goal();
    const Eigen::Vector3d moved = log_rotation(now.x.Q * last.x.Q.conjugate());
    ASSERT_TRUE(moved.isApprox(0.5 * kStep_s * (now.v + last.v).tail<3>(), 1e-3) ||
                (moved - 0.5 * kStep_s * (now.v + last.v).tail<3>()).norm() < 2e-6)
        << t;
    const bool bound_acts = motion.bounded() || bounded;
    bounded = motion.bounded();
    if (!bound_acts) {
      // At a knot the jerk may step, by which the trapezoid rule is off.
      ASSERT_LT((now.v - last.v - 0.5 * kStep_s * (now.a + last.a)).norm(), 5e-4) << t;
    }
    turned += moved.norm();
    if (!bound_acts) jump_a = std::max(jump_a, (now.a - last.a).norm());
    last = now;
  }
  EXPECT_GT(turned, 2.0 * std::numbers::pi);
  EXPECT_LT(jump_a, 2.0);
}

}  // namespace
}  // namespace limber::controller
