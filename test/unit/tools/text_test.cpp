// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Texts that tools write and show.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "rgbd_sfm_fusion/tools/number_text.h"
#include "rgbd_sfm_fusion/tools/progress.h"
#include "rgbd_sfm_fusion/tools/run_report.h"
#include "rgbd_sfm_fusion/tools/text_format.h"
#include "rgbd_sfm_fusion/tools/tum_sequence.h"

namespace rgbd_sfm_fusion {
namespace {

TEST(FormatStamp, HasAllNanosecondsAndReadsBack) {
  EXPECT_EQ(formatStamp(1305031102175304000), "1305031102.175304000");
  EXPECT_EQ(formatStamp(1), "0.000000001");
  EXPECT_EQ(formatStamp(kNoStamp), "");
  for (const Stamp stamp : {Stamp{0}, Stamp{999'999'999}, Stamp{1'000'000'000}, Stamp{4294967295999999999}}) {
    EXPECT_EQ(parseStamp(formatStamp(stamp)), stamp);
  }
}

TEST(FormatNumber, IsFixedAndKnowsNan) {
  EXPECT_EQ(formatNumber(0.5, 3), "0.500");
  EXPECT_EQ(formatNumber(1e-9, 3), "0.000");
  EXPECT_EQ(formatNumber(123456789.0, 1), "123456789.0");
  EXPECT_EQ(formatNumber(std::numeric_limits<double>::quiet_NaN(), 3), "nan");
  EXPECT_EQ(formatNumber(-std::numeric_limits<double>::quiet_NaN(), 3), "nan");
}

TEST(NumberText, IsTheShortestThatReadsBack) {
  EXPECT_EQ(numberText(0.1), "0.1");
  EXPECT_EQ(numberText(0.1F), "0.1");
  EXPECT_EQ(numberText(1e-6), "1e-06");
  EXPECT_EQ(numberText(1e6), "1000000");
  EXPECT_EQ(numberText(-100), "-100");
  EXPECT_EQ(numberText(std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(numberText(-std::numeric_limits<double>::infinity()), "-inf");
  for (const double value : {1.0 / 3.0, 1234567.8, 5e-324, 1.7e308, -0.0, 0.30000000000000004})
    EXPECT_EQ(readNumber(numberText(value)), value) << numberText(value);
  for (const float value : {1.0F / 3.0F, 1.425e-3F, 3e38F})
    EXPECT_EQ(static_cast<float>(readNumber(numberText(value)).value()), value) << numberText(value);
}

TEST(ReadNumber, TakesAFiniteNumberAndNothingElse) {
  EXPECT_EQ(readNumber(" 2.5 "), 2.5);
  for (const char* text : {"", " ", "nan", "inf", "-inf", "1e999", "1,5", "1.5x", "1 2", "many"})
    EXPECT_FALSE(readNumber(text)) << text;
}

TEST(FormatPose, IsTranslationThenQuaternionWithPositiveW) {
  const SE3 T(Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5), {1, 2, 3});
  EXPECT_EQ(formatPose(T, ' '),
            "1.000000000 2.000000000 3.000000000 -0.500000000 0.500000000 -0.500000000 0.500000000");
}

TEST(Percentiles, AreValuesOfTheList) {
  const Percentiles none = percentiles({});
  EXPECT_EQ(none.p50 + none.p95 + none.p99, 0.0);
  const Percentiles one = percentiles({7.0});
  EXPECT_EQ(one.p50, 7.0);
  EXPECT_EQ(one.p99, 7.0);
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const Percentiles many = percentiles(values);
  EXPECT_EQ(many.p50, 50.0);
  EXPECT_EQ(many.p95, 95.0);
  EXPECT_EQ(many.p99, 99.0);
}

TEST(ProgressText, SaysHowFarHowFastAndHowLong) {
  EXPECT_EQ(progressText(0, 360, 0.0), "0/360 frames");
  EXPECT_EQ(progressText(120, 360, 4.0), "120/360 frames (33 %), 30.0 per second, 0:08 left");
  EXPECT_EQ(progressText(10, 3610, 10.0), "10/3610 frames (0 %), 1.0 per second, 60:00 left");
  EXPECT_EQ(progressText(360, 360, 12.0), "360/360 frames (100 %), 30.0 per second, 0:00 left");
  EXPECT_EQ(progressText(5, 0, 1.0), "5/0 frames");
}

}  // namespace
}  // namespace rgbd_sfm_fusion
