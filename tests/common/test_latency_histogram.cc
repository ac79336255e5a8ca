#include <gtest/gtest.h>

#include "common/latency_histogram.h"

namespace limber::test_latency_histogram {
namespace {

TEST(LatencyHistogram, IsEmptyAtFirst) {
  const LatencyHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0);
  EXPECT_EQ(histogram.max(), 0);
}

TEST(LatencyHistogram, QuantilesAreRightToFivePercent) {
  LatencyHistogram histogram;
  for (int i = 1; i <= 100'000; ++i) histogram.add(i);
  for (const double q : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const double exact = q * 100'000;
    EXPECT_GE(histogram.quantile(q), exact * 0.999) << q;
    EXPECT_LE(histogram.quantile(q), exact * 1.07) << q;
  }
  EXPECT_EQ(histogram.quantile(1.0), 100'000);
  EXPECT_EQ(histogram.max(), 100'000);
}

TEST(LatencyHistogram, SmallAndNegativeValuesAreExact) {
  LatencyHistogram histogram;
  histogram.add(-5);
  histogram.add(3);
  histogram.add(15);
  EXPECT_EQ(histogram.quantile(0.01), 0);
  EXPECT_EQ(histogram.quantile(0.5), 3);
  EXPECT_EQ(histogram.quantile(1.0), 15);
}

TEST(LatencyHistogram, HugeValuesLandInTheLastBin) {
  LatencyHistogram histogram;
  histogram.add(INT64_MAX);
  EXPECT_EQ(histogram.count(), 1);
  EXPECT_EQ(histogram.max(), INT64_MAX);
}

}  // namespace
}  // namespace limber::test_latency_histogram
