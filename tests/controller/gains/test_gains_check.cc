// A gains message against the table: every kind of row at its bounds, and the words of its refusal.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "controller/gains/gains_check.h"
#include "controller/laws/registry.h"

namespace limber::controller::test_gains_check {
namespace {

using Message = compliance_gains_t;
using Change = std::function<void(Message&)>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr int kJoints = 2;

double after(double x) { return std::nextafter(x, kInf); }
float after(float x) { return std::nextafter(x, std::numeric_limits<float>::infinity()); }

/// Why standard gains with one change are refused; "": they are not.
std::string why(const Change& change, bool simulated = false) {
  Message message = standard_gains();
  message.num_joints = kJoints;
  change(message);
  const GainsCheck checker(kJoints, simulated, law_catalog().parameters);
  const char* reason = checker.check(message, message);
  return reason == nullptr ? "" : reason;
}

TEST(GainsCheck, TheTablesDefaultsAreAllowed) {
  EXPECT_EQ(why([](Message&) {}), "");
}

TEST(GainsCheck, ThisArmsJoints) {
  for (const int joints : {0, 1, 3}) {
    EXPECT_EQ(why([=](Message& m) { m.num_joints = static_cast<std::int8_t>(joints); }),
              "num_joints is not the number of joints of this arm");
  }
}

TEST(GainsCheck, NumbersWithinTheirRange) {
  const auto ratio = [](double x) { return why([=](Message& m) { m.damping_ratio = x; }); };
  EXPECT_EQ(ratio(0.0), "");
  EXPECT_EQ(ratio(2.0), "");
  for (const double bad : {-1e-300, after(2.0), kNan})
    EXPECT_EQ(ratio(bad), "damping_ratio must be within 0..2") << bad;
  const auto gain = [](float x) { return why([=](Message& m) { m.observer_gain_per_s = x; }); };
  EXPECT_EQ(gain(500.0F), "");
  EXPECT_EQ(gain(0.0011F), "");
  for (const float bad : {0.0009F, after(500.0F), std::nanf("")})
    EXPECT_EQ(gain(bad), "observer_gain_per_s must be within 0.001..500 1/s") << bad;
  const auto ramp = [](double x) { return why([=](Message& m) { m.ramp_s = x; }); };
  EXPECT_EQ(ramp(60.0), "");
  EXPECT_EQ(ramp(60.1), "ramp_s must be within 0..60 s");
}

TEST(GainsCheck, OneNumberForEachOfTheArmsJoints) {
  const auto K = [](int joint, double x) { return why([=](Message& m) { m.K_q[joint] = x; }); };
  const auto D = [](int joint, float x) { return why([=](Message& m) { m.D_q[joint] = x; }); };
  for (int joint = 0; joint < kJoints; ++joint) {
    EXPECT_EQ(K(joint, 1e4), "");
    EXPECT_EQ(K(joint, after(1e4)), "K_q_Nm_per_rad must be within 0..10000 N m/rad");
    EXPECT_EQ(D(joint, 1e3F), "");
    EXPECT_EQ(D(joint, -1.0F), "D_q_Nms_per_rad must be within 0..1000 N m s/rad");
  }
  EXPECT_EQ(K(kJoints, kNan), "") << "nobody's";
  EXPECT_EQ(D(kJoints, std::nanf("")), "");
}

TEST(GainsCheck, ThePeriodOfEachTerm) {
  const auto period = [](int term, int cycles) {
    return why([=](Message& m) { m.period_cycles[term] = static_cast<std::int16_t>(cycles); });
  };
  for (int term = 0; term < 5; ++term) {
    EXPECT_EQ(period(term, 1000), "");
    EXPECT_EQ(period(term, 0), "period_cycles must be within 1..1000 cycles") << term;
    EXPECT_EQ(period(term, 1001), "period_cycles must be within 1..1000 cycles") << term;
  }
}

TEST(GainsCheck, ChoicesAreOneOfTheirWords) {
  const auto frame = [](int value) {
    return why([=](Message& m) { m.frame = static_cast<std::int8_t>(value); });
  };
  EXPECT_EQ(frame(0), "");
  EXPECT_EQ(frame(1), "");
  for (const int bad : {-1, 2, 127}) EXPECT_EQ(frame(bad), "frame must be one of base, goal");
  for (std::int8_t last = 0; last <= 4; ++last)
    EXPECT_EQ(why([=](Message& m) { m.orientation = last; }), "");
}

// A diagonal may be anything up to its bounds; those of rotation are others.
TEST(GainsCheck, TheDiagonalOfATipMatrix) {
  const auto K = [](int i, double x) { return why([=](Message& m) { m.K_x[i][i] = x; }); };
  constexpr char kOutside[] =
      "K_x: the diagonal must be within 0..100000 (translation) and 0..10000 (rotation) N/m, "
      "N/rad, N m/rad";
  for (int i = 0; i < 6; ++i) {
    const double high = i < 3 ? 1e5 : 1e4;
    EXPECT_EQ(K(i, high), "") << i;
    EXPECT_EQ(K(i, after(high)), kOutside) << i;
    EXPECT_EQ(K(i, -1e-300), kOutside) << i;
    EXPECT_EQ(K(i, kNan), "K_x is not finite") << i;
  }
}

// `accel_feedback` may take inertia away.
TEST(GainsCheck, AMatrixThatMayBeNegative) {
  const auto M = [](int i, float x) { return why([=](Message& m) { m.M_x[i][i] = x; }); };
  constexpr char kOutside[] =
      "M_x: the diagonal must be within -1000..1000 (translation) and -100..100 (rotation) kg, kg "
      "m, kg m²";
  for (int i = 0; i < 6; ++i) {
    const float high = i < 3 ? 1e3F : 1e2F;
    for (const float sign : {1.0F, -1.0F}) {
      EXPECT_EQ(M(i, sign * high), "") << i;
      EXPECT_EQ(M(i, sign * after(high)), kOutside) << i;
    }
  }
  const Change indefinite = [](Message& m) { m.M_x[0][1] = m.M_x[1][0] = 5.0F; };
  EXPECT_EQ(why(indefinite), "");
}

TEST(GainsCheck, OffTheDiagonalNoMoreThanOnIt) {
  const auto M = [](float x) { return why([=](Message& m) { m.M_x[1][4] = m.M_x[4][1] = x; }); };
  EXPECT_EQ(M(-1e3F), "");
  EXPECT_NE(M(-after(1e3F)), "");
  EXPECT_EQ(why([](Message& m) { m.M_x[5][0] = std::nanf(""); }), "M_x is not finite");
}

// What rounding leaves: 1e-9 of the largest entry in doubles, 1e-6 in floats.
TEST(GainsCheck, SymmetricUpToRounding) {
  const auto K = [](double difference) {
    return why([=](Message& m) {
      m.K_x[0][0] = m.K_x[1][1] = 1000.0;
      m.K_x[1][0] = difference;
    });
  };
  EXPECT_EQ(K(0.99e-6), "");
  EXPECT_EQ(K(1.01e-6), "K_x is not symmetric");
  EXPECT_EQ(K(-1.01e-6), "K_x is not symmetric");
  const auto D = [](float difference) {
    return why([=](Message& m) {
      m.D_x[0][0] = m.D_x[5][5] = 100.0F;
      m.D_x[0][5] = difference;
    });
  };
  EXPECT_EQ(D(0.95e-4F), "");
  EXPECT_EQ(D(1.05e-4F), "D_x is not symmetric");
}

// [k, c; c, k] has the eigenvalues k - c and k + c.
TEST(GainsCheck, PositiveSemidefiniteUpToRounding) {
  const auto K = [](double c) {
    return why([=](Message& m) {
      m.K_x[2][2] = m.K_x[0][0] = 1000.0;
      m.K_x[2][0] = m.K_x[0][2] = c;
    });
  };
  EXPECT_EQ(K(1000.0), "");
  EXPECT_EQ(K(-1000.0), "");
  EXPECT_EQ(K(1000.0 + 0.9e-6), "");
  EXPECT_EQ(K(1000.0 + 1.1e-6), "K_x is not positive semidefinite");
  EXPECT_EQ(K(-1100.0), "K_x is not positive semidefinite");
}

/// One parameter of a law.
Change parameter(const std::string& key, const std::vector<float>& values) {
  return [=](Message& m) { set_parameter(key, values, &m); };
}

TEST(GainsCheck, ParametersOfLaws) {
  constexpr char kSize[] = "parameters: a parameter needs one value, or one value a joint";
  EXPECT_EQ(why(parameter("torque_gain", {0.0F})), "");
  EXPECT_EQ(why(parameter("torque_gain", {20.0F})), "");
  for (const float bad : {-1.0F, after(20.0F), std::nanf("")})
    EXPECT_EQ(why(parameter("torque_gain", {bad})), "torque_gain must be within 0..20") << bad;
  EXPECT_EQ(why(parameter("torque_gain", {})), kSize);
  EXPECT_EQ(why(parameter("torque_gain", {1.0F, 1.0F})), kSize);
  EXPECT_EQ(why(parameter("M_q_kgm2", {1.0F, 100.0F})), "");
  EXPECT_EQ(why(parameter("M_q_kgm2", {1.0F})), kSize);
  EXPECT_EQ(why(parameter("M_q_kgm2", {1.0F, 101.0F})), "M_q_kgm2 must be within 0..100 kg m²");
  EXPECT_EQ(why(parameter("stiffness", {1.0F})), "parameters: no law has a parameter of this name");
}

TEST(GainsCheck, EachOfSeveralParameters) {
  const auto both = [](float first, float second) {
    return why([=](Message& m) {
      set_parameter("torque_gain", {first}, &m);
      set_parameter("inertia_feedforward", {second}, &m);
    });
  };
  EXPECT_EQ(both(1.0F, 1.0F), "");
  EXPECT_EQ(both(21.0F, 1.0F), "torque_gain must be within 0..20");
  EXPECT_EQ(both(1.0F, 2.0F), "inertia_feedforward must be one of false, true");
  EXPECT_EQ(both(1.0F, 0.5F), "inertia_feedforward must be one of false, true");
}

TEST(GainsCheck, MistakesAreDemonstratedInSimulationOnly) {
  const Change mistake = parameter("literal_stiffness", {1.0F});
  EXPECT_EQ(why(mistake, true), "");
  EXPECT_EQ(why(mistake, false),
            "literal_stiffness demonstrates a mistake and is allowed only where every bus is "
            "simulated");
  EXPECT_EQ(why(parameter("literal_stiffness", {0.0F})), "");
}

}  // namespace
}  // namespace limber::controller::test_gains_check
