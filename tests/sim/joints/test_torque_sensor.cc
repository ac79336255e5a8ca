// The torque sensor: what it adds to the torque it is given.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/joints/torque_sensor.h"

namespace limber::sim::test_torque_sensor {
namespace {

constexpr double kStep = 250e-6;

/// Mean, standard deviation and correlation of neighbours in readings of zero torque.
struct Statistics {
  double mean, deviation, correlation;
};

Statistics statistics(TorqueSensor sensor, int count) {
  double sum = 0.0;
  double squares = 0.0;
  double products = 0.0;
  double last = 0.0;
  for (int k = -1000; k < count; ++k) {
    sensor.update(0.0, kStep);
    if (k >= 0) {
      sum += sensor.reading();
      squares += sensor.reading() * sensor.reading();
      products += sensor.reading() * last;
    }
    last = sensor.reading();
  }
  return {sum / count, std::sqrt(squares / count), products / squares};
}

TEST(TorqueSensor, IdealReadsTheTorque) {
  TorqueSensor sensor;
  EXPECT_EQ(sensor.reading(), 0.0);
  for (const double torque : {0.1, -30.0, 7.123456}) {
    sensor.update(torque, kStep);
    EXPECT_EQ(sensor.reading(), torque);
  }
}

TEST(TorqueSensor, ScaleAndBias) {
  TorqueSensorConfig config;
  config.scale = 1.02;
  config.bias_Nm = -0.5;
  TorqueSensor sensor(config, 1);
  sensor.update(10.0, kStep);
  EXPECT_NEAR(sensor.reading(), 9.7, 1e-14);
}

TEST(TorqueSensor, RoundsToItsResolution) {
  TorqueSensorConfig config;
  config.resolution_Nm = 0.25;
  TorqueSensor sensor(config, 1);
  const double cases[][2] = {{0.12, 0.0}, {0.13, 0.25}, {-0.13, -0.25}, {3.9, 4.0}};
  for (const auto& [torque, reading] : cases) {
    sensor.update(torque, kStep);
    EXPECT_EQ(sensor.reading(), reading);
  }
}

TEST(TorqueSensor, FilterIsALagWhateverTheStep) {
  TorqueSensorConfig config;
  config.filter_s = 2e-3;
  for (const double h : {1e-3, 250e-6, 62.5e-6}) {
    TorqueSensor sensor(config, 1);
    sensor.update(3.0, h);
    EXPECT_EQ(sensor.reading(), 3.0);  // found settled
    for (int k = 1; k <= 10; ++k) {
      sensor.update(8.0, h);
      EXPECT_NEAR(sensor.reading(), 8.0 - 5.0 * std::exp(-k * h / 2e-3), 1e-12);
    }
  }
}

TEST(TorqueSensor, DelaysByWholeUpdates) {
  TorqueSensorConfig config;
  for (const int delay : {0, 1, 4, static_cast<int>(TorqueSensor::kMaxDelay)}) {
    config.delay_s = delay * kStep;
    TorqueSensor sensor(config, 1);
    for (int k = 0; k < 1000; ++k) {
      sensor.update(k, kStep);
      EXPECT_EQ(sensor.reading(), std::max(k - delay, 0));
    }
  }
}

TEST(TorqueSensor, LongestDelayIsNotExceeded) {
  TorqueSensorConfig config;
  config.delay_s = 10.0;
  TorqueSensor sensor(config, 1);
  for (int k = 0; k < 1000; ++k) sensor.update(k, kStep);
  EXPECT_EQ(sensor.reading(), 999.0 - static_cast<double>(TorqueSensor::kMaxDelay));
}

// 100,000 samples: the mean is within 4 sigma / sqrt(n), the deviation within 4 sigma / sqrt(2 n).
TEST(TorqueSensor, NoiseHasItsStandardDeviationAndNoMemory) {
  constexpr int kCount = 100'000;
  TorqueSensorConfig config;
  config.noise_Nm = 0.2;
  const Statistics found = statistics(TorqueSensor(config, 7), kCount);
  EXPECT_NEAR(found.mean, 0.0, 4.0 * 0.2 / std::sqrt(kCount));
  EXPECT_NEAR(found.deviation, 0.2, 4.0 * 0.2 / std::sqrt(2.0 * kCount));
  EXPECT_NEAR(found.correlation, 0.0, 4.0 / std::sqrt(kCount));
}

// A one-pole filter p = exp(-h / filter_s) leaves sqrt((1 - p) / (1 + p)) of white noise, and
// neighbours correlated by p.
TEST(TorqueSensor, FilterCalmsTheNoise) {
  TorqueSensorConfig config;
  config.noise_Nm = 0.2;
  config.filter_s = 1e-3;
  const double p = std::exp(-kStep / 1e-3);
  const Statistics found = statistics(TorqueSensor(config, 7), 100'000);
  EXPECT_NEAR(found.deviation, 0.2 * std::sqrt((1.0 - p) / (1.0 + p)), 0.001);
  EXPECT_NEAR(found.correlation, p, 0.01);
}

TEST(TorqueSensor, NoiseRepeatsWithItsSeedOnly) {
  TorqueSensorConfig config;
  config.noise_Nm = 1.0;
  TorqueSensor one(config, 1);
  TorqueSensor again(config, 1);
  TorqueSensor other(config, 2);
  double together = 0.0;
  constexpr int kCount = 10'000;
  for (int k = 0; k < kCount; ++k) {
    one.update(0.0, kStep);
    again.update(0.0, kStep);
    other.update(0.0, kStep);
    EXPECT_EQ(one.reading(), again.reading());
    together += one.reading() * other.reading() / kCount;
  }
  EXPECT_NEAR(together, 0.0, 4.0 / std::sqrt(kCount));
}

}  // namespace
}  // namespace limber::sim::test_torque_sensor
