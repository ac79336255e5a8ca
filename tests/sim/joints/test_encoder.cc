// Encoders that are not perfect: what they add to the angle they are given.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/joints/encoder.h"

namespace limber::sim::test_encoder {
namespace {

constexpr double kStep = 250e-6;

TEST(Encoder, PerfectReadsTheAngle) {
  Encoder encoder;
  encoder.update({0.3, 2.0}, kStep);
  EXPECT_EQ(encoder.reading({0.4, 3.0}).angle, 0.4);
  EXPECT_EQ(encoder.reading({0.4, 3.0}).rate, 3.0);
}

TEST(Encoder, BiasAndEccentricity) {
  EncoderErrors errors;
  errors.bias_rad = -0.002;
  errors.eccentricity_rad = 0.01;
  Encoder encoder(errors, 1);
  encoder.update({0.5, 2.0}, kStep);
  encoder.update({0.5, 2.0}, kStep);
  const AngleReading reading = encoder.reading({0.5, 2.0});
  EXPECT_NEAR(reading.angle, 0.5 - 0.002 + 0.01 * std::sin(0.5), 1e-15);
  EXPECT_NEAR(reading.rate, 2.0 * (1.0 + 0.01 * std::cos(0.5)), 1e-15);
}

// A ramp of 3 rad/s that comes 1 ms late reads 3 mrad too little.
TEST(Encoder, DelayIsWholeUpdates) {
  EncoderErrors errors;
  errors.delay_s = 0.001;
  Encoder encoder(errors, 1);
  double angle = 0.0;
  for (int k = 0; k < 100; ++k) {
    angle = 3.0 * kStep * k;
    encoder.update({angle, 3.0}, kStep);
  }
  EXPECT_NEAR(encoder.reading({angle, 3.0}).angle, angle - 0.003, 1e-12);
  EXPECT_EQ(encoder.reading({angle, 3.0}).rate, 3.0);
}

TEST(Encoder, NoiseHasItsDeviationAndItsSeed) {
  EncoderErrors errors;
  errors.noise_rad = 1e-4;
  Encoder one(errors, 1);
  Encoder same(errors, 1);
  Encoder other(errors, 2);
  constexpr int kCount = 20'000;
  double sum = 0.0;
  double squares = 0.0;
  int alike = 0;
  for (int k = 0; k < kCount; ++k) {
    for (Encoder* encoder : {&one, &same, &other}) encoder->update({1.0, 0.0}, kStep);
    const double error = one.reading({1.0, 0.0}).angle - 1.0;
    EXPECT_EQ(error, same.reading({1.0, 0.0}).angle - 1.0);
    if (error == other.reading({1.0, 0.0}).angle - 1.0) ++alike;
    sum += error;
    squares += error * error;
  }
  EXPECT_EQ(alike, 0);
  EXPECT_NEAR(sum / kCount, 0.0, 4.0 * 1e-4 / std::sqrt(kCount));
  EXPECT_NEAR(std::sqrt(squares / kCount), 1e-4, 2e-6);
}

}  // namespace
}  // namespace limber::sim::test_encoder
