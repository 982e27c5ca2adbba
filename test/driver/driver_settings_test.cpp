// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "driver_settings.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "../comma_locale.h"

namespace rgbd_sfm_fusion {
namespace {

std::string errorOf(const std::string& text) {
  try {
    parseDriverSettings(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(DriverSettings, AQuotedValueMayHaveSpaces) {
  const DriverSettings s = parseDriverSettings("log=\"/a folder/of mine.log\" seed=4 serial=\"\"");
  EXPECT_EQ(s.log, "/a folder/of mine.log");
  EXPECT_EQ(s.camera.seed, 4U);
  EXPECT_EQ(s.serial, "");
}

TEST(DriverSettings, TakesTheLastOfEveryKeyInItsUnit) {
  const DriverSettings s = parseDriverSettings(
      "  seed=3 seed=4\n rate=15\tjitter=8 skew=-10 clock_drift=50 stall=3:0.5,8:2 noise=off serial=A7 ");
  EXPECT_EQ(s.camera.seed, 4U);
  EXPECT_EQ(s.camera.rate, 15.0);
  EXPECT_DOUBLE_EQ(s.jitter, 0.008);
  EXPECT_DOUBLE_EQ(s.camera.skew, -0.01);
  EXPECT_DOUBLE_EQ(s.clock_drift, 50e-6);
  EXPECT_FALSE(s.camera.depth.noise);
  EXPECT_EQ(s.serial, "A7");
  ASSERT_EQ(s.stalls.size(), 2U);
  EXPECT_EQ(s.stalls[1].time, 8.0);
  EXPECT_EQ(s.stalls[1].duration, 2.0);
}

TEST(DriverSettings, PlugTimesTakeTurns) {
  EXPECT_TRUE(parseDriverSettings("").pluggedAtLoad());
  EXPECT_TRUE(parseDriverSettings("unplug=5,15 replug=7,17").pluggedAtLoad());
  const DriverSettings late = parseDriverSettings("replug=9 unplug=8 absent_until=5");
  EXPECT_FALSE(late.pluggedAtLoad());
  ASSERT_EQ(late.plug_events.size(), 3U);
  EXPECT_FALSE(late.plug_events[1].plugged);
  for (const char* text :
       {"replug=5", "unplug=5,6", "unplug=5 replug=4", "unplug=5 replug=5", "absent_until=5 replug=6"})
    EXPECT_NE(errorOf(text), "") << text;
}

TEST(DriverSettings, ErrorsNameTheKeyAndWhatWasExpected) {
  for (const char* text : {"rate=", "rate=x", "rate=30Hz", "rate=nan", "rate=0", "rate=1e9", "rate=30 Hz"})
    EXPECT_NE(errorOf(text), "") << text;
  EXPECT_EQ(errorOf("rate=x"), "rate=x: expected a number from 1 to 120");
  EXPECT_EQ(errorOf("noise=1"), "noise=1: expected on or off");
  EXPECT_EQ(errorOf("jiter=5"), "jiter: no such key; the most similar one is jitter");
  EXPECT_EQ(errorOf("stall=3").substr(0, 24), "stall=3: expected TIME:D");
}

TEST(DriverSettings, AreTheSameUnderALocaleWithADecimalComma) {
  const CommaLocale locale;
  EXPECT_DOUBLE_EQ(parseDriverSettings("skew=-10.5").camera.skew, -0.0105);
  EXPECT_EQ(parseDriverSettings("seed=123456").camera.seed, 123456U);
  EXPECT_EQ(errorOf("skew=10,5"), "skew=10,5: expected a number from -1000 to 1000");
}

}  // namespace
}  // namespace rgbd_sfm_fusion
