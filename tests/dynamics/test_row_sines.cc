// Sines and cosines of all joints against those of the C library.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "dynamics/row_sines.h"

namespace limber::dynamics::plain::test_row_sines {
namespace {

using Angles = std::array<double, 8>;

void expect_sines(const Angles& angle) {
  const RowSines<8> found = sines(loaded<8>(angle.data()));
  for (int i = 0; i < 8; ++i) {
    ASSERT_NEAR(lane(found.sine, i), std::sin(angle[i]), 3e-16) << angle[i];
    ASSERT_NEAR(lane(found.cosine, i), std::cos(angle[i]), 3e-16) << angle[i];
  }
}

TEST(RowSines, OfAnyAngle) {
  std::mt19937 random(1);
  for (const double greatest : {1e-9, 0.1, 4.0, 1e3, 1e6}) {
    std::uniform_real_distribution<double> uniform(-greatest, greatest);
    for (int i = 0; i < 10'000; ++i) {
      Angles angle;
      for (int k = 0; k < 8; ++k) angle[k] = uniform(random);
      expect_sines(angle);
    }
  }
}

// Where one quarter turn passes into the next, which is half way between two.
TEST(RowSines, AtQuarterAndEighthTurns) {
  for (int turn = -10'000; turn <= 10'000; ++turn) {
    const double angle = turn * std::numbers::pi / 4.0;
    expect_sines(Angles{angle, std::nextafter(angle, -1e9), std::nextafter(angle, 1e9), -angle,
                        angle - 1e-9, angle + 1e-9, 0.0, -0.0});
  }
}

TEST(RowSines, OfWhatIsNotFinite) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const Angles angle = {std::numeric_limits<double>::quiet_NaN(), kInfinite, -kInfinite};
  const RowSines<8> found = sines(loaded<8>(angle.data()));
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(std::isnan(lane(found.sine, i)));
    EXPECT_TRUE(std::isnan(lane(found.cosine, i)));
  }
  EXPECT_EQ(lane(found.sine, 3), 0.0);
  EXPECT_EQ(lane(found.cosine, 3), 1.0);
}

}  // namespace
}  // namespace limber::dynamics::plain::test_row_sines
