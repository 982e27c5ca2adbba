// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/settings/settings.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <set>
#include <stdexcept>

#include "../temporary_path.h"
#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

class SettingsFile : public ::testing::Test {
 protected:
  void TearDown() override { std::remove(path_.c_str()); }

  Settings load(const std::string& text) {
    std::ofstream(path_) << text;
    Settings settings;
    loadSettings({path_}, &settings);
    return settings;
  }

  std::string errorOf(const std::string& text) {
    try {
      load(text);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }

  std::string path_ = temporaryPath("settings_test.yaml");
};

std::string errorOf(const std::string& assignment) {
  Settings settings;
  try {
    applyAssignment(assignment, &settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(SettingsTable, EveryRowIsComplete) {
  std::set<std::string> names;
  for (const Setting& setting : allSettings()) {
    EXPECT_TRUE(names.insert(setting.name).second) << setting.name << " twice";
    EXPECT_FALSE(setting.description.empty()) << setting.name;
    EXPECT_FALSE(setting.section.empty()) << setting.name;
    EXPECT_FALSE(setting.range.empty()) << setting.name;
  }
}

TEST(SettingsTable, DefaultsAreInRangeAndSurviveARoundTrip) {
  for (const Setting& setting : allSettings()) {
    Settings settings;
    const std::string value = setting.get(settings);
    EXPECT_NO_THROW(setting.set(settings, value)) << setting.name << " = " << value;
    EXPECT_EQ(setting.get(settings), value) << setting.name;
  }
  EXPECT_NO_THROW(validate(Settings()));
}

TEST(SettingsTable, NumbersReadAsPeopleWriteThem) {
  EXPECT_EQ(findSetting("max_range").range, "0.1 to 100");
  EXPECT_EQ(findSetting("max_chi_squared").range, "0.1 to 1000000");
  EXPECT_EQ(findSetting("noise_quadratic").get(Settings()), "0.001425");
  EXPECT_EQ(findSetting("scale_min_pixels").get(Settings()), "200");
}

TEST(SettingsTable, NumbersTakeTheirLimitsAndNothingBeyond) {
  for (const Setting& setting : allSettings()) {
    if (setting.kind != Setting::Kind::kNumber && setting.kind != Setting::Kind::kInteger) continue;
    Settings settings;
    for (const double limit : {setting.minimum, setting.maximum}) {
      setting.set(settings, numberText(limit));
      EXPECT_EQ(setting.get(settings), numberText(limit)) << setting.name;
      EXPECT_FLOAT_EQ(static_cast<float>(setting.value(settings)), static_cast<float>(limit)) << setting.name;
    }
    const std::string before = setting.get(settings);
    for (const std::string& bad :
         {std::to_string(setting.minimum - 1.0), std::to_string(setting.maximum + 1.0), std::string("nan"),
          std::string("inf"), std::string("-inf"), std::string(""), std::string("1 2"), std::string("1x"),
          std::string("many")}) {
      EXPECT_THROW(setting.set(settings, bad), std::invalid_argument) << setting.name << " = " << bad;
    }
    EXPECT_EQ(setting.get(settings), before) << setting.name;
  }
}

TEST(SettingsTable, BooleansAndChoicesTakeEveryValue) {
  for (const Setting& setting : allSettings()) {
    Settings settings;
    for (const std::string& choice : setting.choices) {
      setting.set(settings, choice);
      EXPECT_EQ(setting.get(settings), choice) << setting.name;
    }
    if (setting.kind == Setting::Kind::kChoice) {
      EXPECT_THROW(setting.set(settings, "other"), std::invalid_argument) << setting.name;
    }
    if (setting.kind != Setting::Kind::kBoolean) continue;
    for (const char* yes : {"on", "true", "True", "yes", "1"}) {
      setting.set(settings, yes);
      EXPECT_EQ(setting.get(settings), "on") << setting.name;
    }
    for (const char* no : {"off", "False", "NO", "0"}) {
      setting.set(settings, no);
      EXPECT_EQ(setting.get(settings), "off") << setting.name;
    }
    EXPECT_THROW(setting.set(settings, "maybe"), std::invalid_argument) << setting.name;
  }
}

TEST(Settings, UnknownNameGetsTheNearestAndAll) {
  const std::string error = errorOf("sensor_feedbak=on");
  EXPECT_TRUE(mentions(error, "'sensor_feedback'?")) << error;
  EXPECT_TRUE(mentions(error, "scale_estimator")) << error;
}

TEST(Settings, OutOfRangeSaysNameValueRangeAndUnit) {
  const std::string error = errorOf("max_skew=7");
  for (const char* part : {"max_skew", "7", "0 to 1", " s"}) EXPECT_TRUE(mentions(error, part)) << error;
  EXPECT_TRUE(mentions(errorOf("threads=1.5"), "whole number"));
  EXPECT_TRUE(mentions(errorOf("init=sonar"), "depth or random"));
  EXPECT_TRUE(mentions(errorOf("close_gaps"), "key=value"));
}

TEST(Settings, CompensateSkewIsOneSettingOfBothStages) {
  Settings settings;
  applyAssignment("compensate_skew=off", &settings);
  EXPECT_FALSE(settings.odometry.compensate_skew);
  EXPECT_FALSE(settings.fusion.compensate_skew);
}

TEST(Settings, ContradictionsAreFound) {
  Settings settings;
  applyAssignment("min_range=3", &settings);
  applyAssignment("max_range=2", &settings);
  EXPECT_THROW(validate(settings), std::invalid_argument);
}

TEST_F(SettingsFile, WhatItNamesChangesAndTheRestStays) {
  const Settings settings =
      load("sensor_feedback: off\nmax_skew: 0.5 # [s]\n\nscale_estimator: mean_ratio\n");
  EXPECT_FALSE(settings.odometry.sensor_feedback);
  EXPECT_EQ(settings.association.max_skew, 0.5);
  EXPECT_EQ(settings.fusion.scale.estimator, ScaleEstimatorKind::kMeanRatio);
  EXPECT_EQ(settings.fusion.gaussian.max_relative_sigma, 0.2);
}

TEST_F(SettingsFile, APresetYieldsToWhatTheFileSaysWhereverItStands) {
  EXPECT_EQ(load("noise_floor: 0.05\nsensor: astra\n").fusion.noise.floor, 0.05F);
  EXPECT_EQ(load("sensor: astra\n").fusion.noise.max_range, DepthNoiseModel::astra().max_range);
}

TEST_F(SettingsFile, TheSensorsRangeIsTheSameForTrackingAndFusion) {
  const Settings settings = load("sensor: astra\nmax_range: 3.5\n");
  EXPECT_EQ(settings.odometry.noise.max_range, 3.5F);
  EXPECT_EQ(settings.fusion.noise.max_range, 3.5F);
  EXPECT_EQ(settings.odometry.noise.min_range, DepthNoiseModel::astra().min_range);
}

TEST_F(SettingsFile, TheUnitOfDepthIsASetting) {
  EXPECT_EQ(load("").run.depth_scale, 0.001);
  EXPECT_EQ(load("depth_scale: 0.0002\n").run.depth_scale, 0.0002);
  EXPECT_TRUE(mentions(errorOf("depth_scale: 5000\n"), "expected 1e-06 to 1 m"))
      << errorOf("depth_scale: 5000\n");
}

TEST_F(SettingsFile, ErrorsNameTheLine) {
  EXPECT_TRUE(mentions(errorOf("max_skew: 0.1\nmax_skw: 0.1\n"), path_ + ", line 2: there is no setting"))
      << errorOf("max_skew: 0.1\nmax_skw: 0.1\n");
  EXPECT_TRUE(mentions(errorOf("\n\nmax_skew: 100\n"), ", line 3: max_skew = 100"));
  EXPECT_TRUE(mentions(errorOf("max_skew: [1, 2]\n"), ", line 1: expected 'name: value'"));
  EXPECT_TRUE(mentions(errorOf("- a\n- b\n"), "expected lines 'name: value'"));
  EXPECT_TRUE(mentions(errorOf("a: 'b\n"), path_ + ", line"));
  Settings settings;
  EXPECT_THROW(loadSettings({"/nonexistent.yaml"}, &settings), std::invalid_argument);
}

TEST_F(SettingsFile, NothingChangesWhereAnythingIsWrong) {
  std::ofstream(path_) << "max_skew: 0.5\nmax_skw: 1\n";
  Settings settings;
  EXPECT_THROW(loadSettings({path_}, &settings), std::invalid_argument);
  EXPECT_EQ(settings.association.max_skew, Settings().association.max_skew);
}

TEST_F(SettingsFile, SeveralFilesAreReadAsIfTheyWereOne) {
  const std::string other = temporaryPath("other_settings_test.yaml");
  std::ofstream(path_) << "noise_floor: 0.05\nmax_skew: 0.1\nkeyframe_lost: 0.4\n";
  std::ofstream(other) << "sensor: astra\nmax_skew: 0.2\n";
  Settings settings;
  loadSettings({path_, other}, &settings);
  EXPECT_EQ(settings.fusion.noise.floor, 0.05F) << "the preset of the second file must not undo the first";
  EXPECT_EQ(settings.fusion.noise.max_range, DepthNoiseModel::astra().max_range);
  EXPECT_EQ(settings.association.max_skew, 0.2) << "the later value counts";
  EXPECT_EQ(settings.odometry.keyframe.max_out_of_view, 0.4F);

  const Settings before = settings;
  std::ofstream(other) << "sensor: kinect\nmax_skw: 0.2\n";
  try {
    loadSettings({path_, other}, &settings);
    FAIL() << "a file with an unknown setting was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(mentions(error.what(), other + ", line 2: there is no setting")) << error.what();
  }
  EXPECT_EQ(settings.sensor, before.sensor);
  std::remove(other.c_str());
}

TEST_F(SettingsFile, AnEmptyFileIsTheDefaults) {
  EXPECT_EQ(load("# nothing\n").association.max_skew, Settings().association.max_skew);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
