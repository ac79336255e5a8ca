// Sines and cosines of all joints against those of the C library.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "dynamics/row_sines.h"

namespace limber::dynamics::test_row_sines {
namespace {

void expect_sines(const Row<8>& angle) {
  const RowSines<8> found = sines<8>(angle);
  for (int i = 0; i < 8; ++i) {
    ASSERT_NEAR(found.sine[i], std::sin(angle[i]), 3e-16) << angle[i];
    ASSERT_NEAR(found.cosine[i], std::cos(angle[i]), 3e-16) << angle[i];
  }
}

TEST(RowSines, OfAnyAngle) {
  std::mt19937 random(1);
  for (const double greatest : {1e-9, 0.1, 4.0, 1e3, 1e6}) {
    std::uniform_real_distribution<double> uniform(-greatest, greatest);
    for (int i = 0; i < 10'000; ++i) {
      Row<8> angle;
      for (int k = 0; k < 8; ++k) angle[k] = uniform(random);
      expect_sines(angle);
    }
  }
}

// Where one quarter turn passes into the next, which is half way between two.
TEST(RowSines, AtQuarterAndEighthTurns) {
  for (int turn = -10'000; turn <= 10'000; ++turn) {
    const double angle = turn * std::numbers::pi / 4.0;
    expect_sines(Row<8>{angle, std::nextafter(angle, -1e9), std::nextafter(angle, 1e9), -angle,
                        angle - 1e-9, angle + 1e-9, 0.0, -0.0});
  }
}

TEST(RowSines, OfWhatIsNotFinite) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const RowSines<8> found =
      sines<8>(Row<8>{std::numeric_limits<double>::quiet_NaN(), kInfinite, -kInfinite});
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(std::isnan(found.sine[i]));
    EXPECT_TRUE(std::isnan(found.cosine[i]));
  }
  EXPECT_EQ(found.sine[3], 0.0);
  EXPECT_EQ(found.cosine[3], 1.0);
}

}  // namespace
}  // namespace limber::dynamics::test_row_sines
