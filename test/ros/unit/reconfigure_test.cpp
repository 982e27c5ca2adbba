// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The files in cfg/ offer what the table of settings says, under the same names.
#include <gtest/gtest.h>
#include <rgbd_sfm_fusion/FusionConfig.h>
#include <rgbd_sfm_fusion/TrackerConfig.h>

#include <limits>
#include <stdexcept>

#include "rgbd_sfm_fusion/ros/reconfigure_message.h"

namespace rgbd_sfm_fusion {
namespace {

struct TrackerStage {
  using Config = TrackerConfig;
  static constexpr SettingScope kScope = SettingScope::kTracker;
};
struct FusionStage {
  using Config = FusionConfig;
  static constexpr SettingScope kScope = SettingScope::kFusion;
};

template <class Config>
dynamic_reconfigure::Config toMessage(const Config& config) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  return message;
}

template <class Parameters>
std::map<std::string, double> values(const Parameters& parameters) {
  std::map<std::string, double> values;
  for (const auto& p : parameters) values[p.name] = static_cast<double>(p.value);
  return values;
}

template <class Stage>
class ConfigTest : public ::testing::Test {};
using Stages = ::testing::Types<TrackerStage, FusionStage>;
TYPED_TEST_SUITE(ConfigTest, Stages);

TYPED_TEST(ConfigTest, OffersJustTheTunableSettingsWithTheirDefaults) {
  const auto offered = toMessage(TypeParam::Config::__getDefault__());
  const auto expected = toReconfigureMessage(Settings(), TypeParam::kScope);
  EXPECT_EQ(values(offered.bools), values(expected.bools));
  EXPECT_EQ(values(offered.ints), values(expected.ints));
  EXPECT_EQ(values(offered.doubles), values(expected.doubles));
  std::map<std::string, std::string> offered_choices, expected_choices;
  for (const auto& p : offered.strs) offered_choices[p.name] = p.value;
  for (const auto& p : expected.strs) expected_choices[p.name] = p.value;
  EXPECT_EQ(offered_choices, expected_choices);
}

TYPED_TEST(ConfigTest, HasTheRangesOfTheTable) {
  const auto low = toMessage(TypeParam::Config::__getMin__());
  const auto high = toMessage(TypeParam::Config::__getMax__());
  const auto check = [](const auto& lows, const auto& highs) {
    for (const auto& p : lows) EXPECT_EQ(static_cast<double>(p.value), findSetting(p.name).minimum) << p.name;
    for (const auto& p : highs)
      EXPECT_EQ(static_cast<double>(p.value), findSetting(p.name).maximum) << p.name;
  };
  check(low.doubles, high.doubles);
  check(low.ints, high.ints);
}

TYPED_TEST(ConfigTest, OffersEveryChoice) {
  for (const auto& description : TypeParam::Config::__getParamDescriptions__()) {
    for (const std::string& choice : findSetting(description->name).choices) {
      EXPECT_NE(description->edit_method.find("'" + choice + "'"), std::string::npos)
          << description->name << ": " << choice;
    }
  }
}

TEST(ReconfigureMessage, ChangesWhatItNames) {
  Settings wanted, settings;
  applyAssignment("sensor_feedback=off", &wanted);
  applyAssignment("keyframe_rate=12.5", &wanted);
  applyReconfigureMessage(toReconfigureMessage(wanted, SettingScope::kTracker), &settings);
  EXPECT_FALSE(settings.odometry.sensor_feedback);
  EXPECT_EQ(settings.run.keyframe_rate, 12.5);
}

TEST(ReconfigureMessage, ChangesNothingWhereAnythingIsWrong) {
  Settings settings;
  dynamic_reconfigure::Config message = toReconfigureMessage(settings, SettingScope::kFusion);
  for (auto& p : message.bools) p.value = !p.value;
  for (auto& p : message.doubles) {
    if (p.name == "max_range") p.value = std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_THROW(applyReconfigureMessage(message, &settings), std::invalid_argument);
  EXPECT_EQ(settings.fusion.compensate_skew, Settings().fusion.compensate_skew);

  message = toReconfigureMessage(settings, SettingScope::kFusion);
  message.strs.at(0).value = "nonsense";
  EXPECT_THROW(applyReconfigureMessage(message, &settings), std::invalid_argument);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
