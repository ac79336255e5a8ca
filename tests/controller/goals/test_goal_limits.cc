// What a goal may be and how long it takes at least: each bound by itself, on both sides.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "controller/goals/goal_limits.h"

namespace limber::controller::test_goal_limits {
namespace {

using Goal = compliance_goal_t;
using Change = std::function<void(Goal&)>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kPi = std::numbers::pi;
constexpr char kFar[] = "the goal is more than 10 m from the base";
constexpr char kWrench[] = "F_ff must be within 200 N and 50 N m";
constexpr char kJointLimits[] = "q is outside the joint limits";

/// Of the kinds of refusal: what the goal is wrong about, and where else it is too much.
int kind_of(const std::string& reason) {
  using Answer = request_answer_t;
  if (reason.empty()) return Answer::REFUSED_NOTHING;
  if (reason.starts_with("the law")) return Answer::REFUSED_GOAL_KIND;
  if (reason.ends_with("at rest")) return Answer::REFUSED_GOAL_MOVING;
  const bool malformed = reason.starts_with("num_joints") || reason.starts_with("kind") ||
                         reason.ends_with("finite") || reason.ends_with("quaternion") ||
                         reason.ends_with("axis");
  return malformed ? Answer::REFUSED_MALFORMED : Answer::REFUSED_GOAL_LIMIT;
}

double after(double x) { return std::nextafter(x, kInf); }

class GoalLimitsTest : public ::testing::Test {
 protected:
  GoalLimitsTest() : limits_(robot()) {
    goal_.num_joints = 2;
    goal_.kind = Goal::GOAL_POSE;
    goal_.quat_BD[0] = 1.0;
  }
  static Robot robot() {
    Robot robot;
    robot.joints.resize(2);
    robot.joints[0].position_min = -1.0;
    robot.joints[0].position_max = 1.5;
    robot.joints[0].velocity_limit = 2.0;
    robot.joints[1].position_min = -2.0;
    robot.joints[1].position_max = 3.0;
    robot.joints[1].velocity_limit = 5.0;
    return robot;
  }
  /// Why the goal is refused; "": it is not.
  std::string why(const Change& change = [](Goal&) {}) const {
    Goal goal = goal_;
    change(goal);
    const Refusal refusal = limits_.check(goal, type_, end_, moving_);
    const std::string reason = refusal ? refusal.reason : "";
    EXPECT_EQ(int{refusal.code}, kind_of(reason)) << reason;
    return reason;
  }

  GoalLimits limits_;
  Goal goal_{};
  GoalType type_ = GoalType::kPose;
  Pose end_;
  bool moving_ = false;
};

TEST_F(GoalLimitsTest, ThisArmsJointsAndALawThatFollows) {
  EXPECT_EQ(why(), "");
  EXPECT_EQ(why([](Goal& g) { g.num_joints = 1; }), "num_joints is not this arm's");
  EXPECT_EQ(why([](Goal& g) { g.num_joints = 3; }), "num_joints is not this arm's");
  type_ = GoalType::kNone;
  EXPECT_EQ(why(), "the law follows no goal");
}

TEST_F(GoalLimitsTest, TenMinutesAtMost) {
  const auto in = [this](double duration_s) {
    return why([=](Goal& g) { g.duration_s = duration_s; });
  };
  EXPECT_EQ(in(600.0), "");
  for (const double bad : {-1e-300, after(600.0), kNan, -kInf, kInf})
    EXPECT_EQ(in(bad), "duration_s must be within 0..600 s") << bad;
}

TEST_F(GoalLimitsTest, AForceOf200NAndAMomentOf50Nm) {
  const auto with = [this](double fx, double fy, double mx, double my) {
    return why([=](Goal& g) {
      g.F_ff[0] = fx;
      g.F_ff[1] = fy;
      g.F_ff[4] = mx;
      g.F_ff[5] = my;
    });
  };
  EXPECT_EQ(with(120.0, -160.0, -30.0, 40.0), "") << "200 N and 50 N m";
  EXPECT_EQ(with(120.1, -160.0, 0.0, 0.0), kWrench);
  EXPECT_EQ(with(0.0, 0.0, -30.1, 40.0), kWrench);
  EXPECT_EQ(with(kNan, 0.0, 0.0, 0.0), kWrench);
  EXPECT_EQ(with(0.0, 0.0, 0.0, kNan), kWrench);
}

TEST_F(GoalLimitsTest, NoWrenchForLawsOfTheJoints) {
  const Change tiny = [](Goal& g) { g.F_ff[3] = 1e-300; };
  for (const GoalType without : {GoalType::kJoints, GoalType::kSmoothJoints}) {
    type_ = without;
    EXPECT_EQ(why(), "");
    EXPECT_EQ(why(tiny), "the law exerts no feed-forward wrench");
  }
  type_ = GoalType::kJointsAndWrench;
  EXPECT_EQ(why(tiny), "");
}

TEST_F(GoalLimitsTest, JointGoalsWithinTheJointsLimits) {
  goal_.kind = Goal::GOAL_JOINT;
  EXPECT_EQ(why(), "the law follows pose goals, not joint goals");
  for (const GoalType type :
       {GoalType::kJoints, GoalType::kJointsAndWrench, GoalType::kSmoothJoints}) {
    type_ = type;
    const auto at = [this](double a, double b) {
      return why([=](Goal& g) {
        g.q[0] = a;
        g.q[1] = b;
        g.q[2] = kNan;
      });
    };
    EXPECT_EQ(at(-1.0, -2.0), "");
    EXPECT_EQ(at(1.5, 3.0), "");
    for (const double bad : {-after(1.0), after(1.5), kNan, kInf, -kInf})
      EXPECT_EQ(at(bad, 0.0), kJointLimits) << bad;
    for (const double bad : {-after(2.0), after(3.0), kNan})
      EXPECT_EQ(at(0.0, bad), kJointLimits) << bad;
  }
}

// Of a joint without ends an infinite angle is none either.
TEST_F(GoalLimitsTest, AContinuousJointsGoalIsFinite) {
  Robot turning = robot();
  turning.joints[0].position_min = -kInf;
  turning.joints[0].position_max = kInf;
  limits_ = GoalLimits(turning);
  goal_.kind = Goal::GOAL_JOINT;
  type_ = GoalType::kJoints;
  EXPECT_EQ(why([](Goal& g) { g.q[0] = 1e6; }), "");
  EXPECT_EQ(why([](Goal& g) { g.q[0] = -kInf; }), kJointLimits);
  EXPECT_EQ(why([](Goal& g) { g.q[0] = kInf; }), kJointLimits);
}

TEST_F(GoalLimitsTest, APostureIsCheckedIfItIsUsed) {
  const Change bad = [](Goal& g) { g.q[1] = kNan; };
  for (const std::int8_t kind : {Goal::GOAL_POSE, Goal::GOAL_OFFSET, Goal::GOAL_WRENCH}) {
    goal_.kind = kind;
    goal_.use_posture = 0;
    EXPECT_EQ(why(bad), "");
    goal_.use_posture = 1;
    EXPECT_EQ(why(bad), kJointLimits);
    EXPECT_EQ(why(), "");
  }
}

TEST_F(GoalLimitsTest, APoseIsFiniteWithAUnitQuaternionWithinTenMetres) {
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(why([=](Goal& g) { g.p_BD[i] = kNan; }), "the pose is not finite");
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(why([=](Goal& g) { g.quat_BD[i] = kInf; }), "the pose is not finite");
  EXPECT_EQ(why([](Goal& g) { g.offset[0] = kNan; }), "") << "of another kind of goal";
  const auto norm = [this](double length) {
    return why([=](Goal& g) {
      g.quat_BD[0] = 0.6 * length;
      g.quat_BD[3] = -0.8 * length;
    });
  };
  EXPECT_EQ(norm(1.0099), "");
  EXPECT_EQ(norm(0.9901), "");
  for (const double bad : {0.9899, 1.0101, 0.0})
    EXPECT_EQ(norm(bad), "quat_BD is not a unit quaternion") << bad;
  const auto at = [this](double x, double z) {
    return why([=](Goal& g) {
      g.p_BD[0] = x;
      g.p_BD[2] = z;
    });
  };
  EXPECT_EQ(at(-6.0, 8.0), "");
  EXPECT_EQ(at(-6.01, 8.0), kFar);
}

TEST_F(GoalLimitsTest, AnOffsetCountsFromTheGoalAndTurnsHalfATurnAtMost) {
  goal_.kind = Goal::GOAL_OFFSET;
  end_.p = {4.0, 0.0, 8.0};
  const auto by = [this](double x, double turn) {
    return why([=](Goal& g) {
      g.offset[0] = x;
      g.offset[4] = turn;
    });
  };
  EXPECT_EQ(by(2.0, 0.0), "") << "6 m and 8 m";
  EXPECT_EQ(by(-10.0, 0.0), "");
  EXPECT_EQ(by(2.01, 0.0), kFar);
  EXPECT_EQ(by(kNan, 0.0), kFar);
  EXPECT_EQ(by(0.0, kPi), "");
  EXPECT_EQ(by(0.0, after(kPi)), "the offset turns by more than pi");
  EXPECT_EQ(by(0.0, kNan), "the offset turns by more than pi");
}

TEST_F(GoalLimitsTest, ACircleHasARadiusAnAxisAndATime) {
  goal_.kind = Goal::GOAL_CIRCLE;
  const auto circle = [this](double radius, double axis, double period_s) {
    return why([=](Goal& g) {
      g.offset[1] = radius;
      g.offset[5] = axis;
      g.duration_s = period_s;
    });
  };
  constexpr char kNothing[] = "the circle has no centre or axis";
  constexpr char kFast[] = "the circle is faster than 1 m/s";
  constexpr char kShort[] = "the period must be at least 0.2 s";
  EXPECT_EQ(circle(0.01, 1.0, 0.2), "");
  EXPECT_EQ(circle(0.01, 1.0, 0.1999), kShort);
  EXPECT_EQ(circle(0.0, 1.0, 1.0), kNothing);
  EXPECT_EQ(circle(1e-12, 1.1e-6, 1.0), "");
  EXPECT_EQ(circle(0.1, 1e-6, 1.0), kNothing);
  EXPECT_EQ(circle(kNan, 1.0, 1.0), kNothing);
  EXPECT_EQ(circle(0.1, kNan, 1.0), kNothing);
  const double radius = 3.0 / (2.0 * kPi);
  EXPECT_EQ(circle(radius, 0.5, 3.001), "");
  EXPECT_EQ(circle(radius, 0.5, 2.999), kFast) << "2 pi r in less than 3 s";
  EXPECT_EQ(circle(kInf, 1.0, 1.0), kFast);
  moving_ = true;
  EXPECT_EQ(circle(0.01, 1.0, 1.0), "a circle starts from a goal at rest");
}

TEST_F(GoalLimitsTest, AWrenchAloneNeedsNoPlace) {
  goal_.kind = Goal::GOAL_WRENCH;
  EXPECT_EQ(why([](Goal& g) {
              g.p_BD[0] = kNan;
              g.offset[0] = kNan;
            }),
            "");
}

TEST_F(GoalLimitsTest, AnotherKindIsRefused) {
  for (const int kind : {-1, 5, 127}) {
    EXPECT_EQ(why([=](Goal& g) { g.kind = static_cast<std::int8_t>(kind); }),
              "kind is none of GOAL_POSE, GOAL_JOINT, GOAL_OFFSET, GOAL_WRENCH, GOAL_CIRCLE");
  }
}

// A minimum-jerk motion over d in T peaks at 15/8 d / T.
constexpr double kPeak = 15.0 / 8.0;

TEST_F(GoalLimitsTest, APosesPeakSpeedIsKept) {
  Pose from;
  from.p = {1.0, -1.0, 2.0};
  Pose to = from;
  to.p += Eigen::Vector3d(0.3, -0.4, 0.0);
  EXPECT_NEAR(limits_.pose_time(from, to, false), kPeak * 0.5 / 0.25, 1e-12);
  EXPECT_NEAR(limits_.pose_time(from, to, true), kPeak * 0.5 / 1.0, 1e-12);
  from.Q = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX());
  to.Q = Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitY()) * from.Q;
  to.p = from.p;
  EXPECT_NEAR(limits_.pose_time(from, to, false), kPeak * 1.2 / 1.0, 1e-12);
  EXPECT_NEAR(limits_.pose_time(from, to, true), kPeak * 1.2 / 4.0, 1e-12);
  to.p.x() += 10.0;
  EXPECT_NEAR(limits_.pose_time(from, to, true), kPeak * 10.0 / 1.0, 1e-12) << "the longer one";
}

TEST_F(GoalLimitsTest, TheSlowestJointsPeakSpeedIsKept) {
  const auto time = [this](double a, double b, bool limited) {
    VectorJ from(2);
    from << 0.5, -0.5;
    VectorJ to = from;
    to[0] += a;
    to[1] += b;
    return limits_.joint_time(from, to, limited);
  };
  EXPECT_NEAR(time(-1.0, 0.0, false), kPeak * 1.0 / (0.1 * 2.0), 1e-12);
  EXPECT_NEAR(time(-1.0, 0.0, true), kPeak * 1.0 / (0.5 * 2.0), 1e-12);
  EXPECT_NEAR(time(-1.0, 3.0, true), kPeak * 3.0 / (0.5 * 5.0), 1e-12) << "1.2 s against 1 s";
}

}  // namespace
}  // namespace limber::controller::test_goal_limits
