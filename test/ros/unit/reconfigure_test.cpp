// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The files in cfg/ offer what the table of settings says, under the same names.
#include <gtest/gtest.h>
#include <rgbd_sfm_fusion/FusionConfig.h>
#include <rgbd_sfm_fusion/TrackerConfig.h>

#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "../../comma_locale.h"
#include "nodelets/camera_reconfiguration.h"
#include "nodelets/reconfiguration.h"
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

TEST(ReconfigureMessage, IsTheSameUnderALocaleWithADecimalComma) {
  const auto offered = toReconfigureMessage(Settings(), SettingScope::kFusion);
  const CommaLocale locale;
  const auto again = toReconfigureMessage(Settings(), SettingScope::kFusion);
  EXPECT_EQ(values(again.doubles), values(offered.doubles));
  EXPECT_EQ(values(again.ints), values(offered.ints));
  dynamic_reconfigure::Config changed = offered;
  for (auto& p : changed.doubles) p.value = p.name == "max_range" ? 4.25 : p.value;
  for (auto& p : changed.ints) p.value = p.name == "scale_min_pixels" ? 123456 : p.value;
  Settings settings;
  ASSERT_NO_THROW(applyReconfigureMessage(changed, &settings));
  EXPECT_EQ(settings.fusion.noise.max_range, 4.25F);
  EXPECT_EQ(settings.fusion.scale.min_pixels, 123456);
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Thrown instead of a standard exception.
struct Other {};

/// A stage's settings, and those that were put in force last.
template <class Stage>
struct Tuned {
  using Config = typename Stage::Config;

  std::optional<Settings> used;
  std::function<void()> before_use = [] {};
  SettingsInForce<Config> settings{Stage::kScope, Settings(), [this](const Settings& changed) {
                                     before_use();
                                     used = changed;
                                   }};

  /// @return the values that are shown after asking for `config`
  Config ask(Config config) {
    settings.config().change(&config);
    return config;
  }
};

/// Values as texts, as NaN is not equal to itself.
template <class Config>
std::map<std::string, std::string> texts(const Config& config) {
  const dynamic_reconfigure::Config message = toMessage(config);
  std::map<std::string, std::string> texts;
  for (const auto& p : message.bools) texts[p.name] = std::to_string(p.value);
  for (const auto& p : message.ints) texts[p.name] = std::to_string(p.value);
  for (const auto& p : message.doubles) texts[p.name] = std::to_string(p.value);
  for (const auto& p : message.strs) texts[p.name] = p.value;
  return texts;
}

TYPED_TEST(ConfigTest, ANumberThatIsNoneIsRefusedAndNotShown) {
  const auto initial = TypeParam::Config::__getDefault__();
  const auto names = toMessage(initial).doubles;
  ASSERT_GT(names.size(), 5U);
  for (const auto& parameter : names) {
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
      Tuned<TypeParam> tuned;
      dynamic_reconfigure::Config message = toMessage(initial);
      for (auto& p : message.doubles) p.value = p.name == parameter.name ? bad : p.value;
      auto config = initial;
      config.__fromMessage__(message);
      ASSERT_NE(texts(config), texts(initial)) << parameter.name;
      EXPECT_EQ(texts(tuned.ask(config)), texts(initial)) << parameter.name << " = " << bad;
      EXPECT_FALSE(tuned.used) << parameter.name << " = " << bad;
    }
  }
}

TEST(SettingsInForce, ShowsWhatIsUsedWhateverIsThrown) {
  const TrackerConfig initial = TrackerConfig::__getDefault__();
  TrackerConfig wanted = initial;
  wanted.keyframe_rate = 7.0;
  const std::function<void()> failures[] = {[] { throw std::invalid_argument("no"); },
                                            [] { throw std::runtime_error("no"); }, [] { throw Other(); }};
  for (const auto& failure : failures) {
    Tuned<TrackerStage> tuned;
    tuned.before_use = failure;
    TrackerConfig shown = wanted;
    EXPECT_NO_THROW(shown = tuned.ask(wanted));
    EXPECT_EQ(shown.keyframe_rate, initial.keyframe_rate);
    EXPECT_FALSE(tuned.used);
    // The next change does not bring in what was refused, either.
    tuned.before_use = [] {};
    TrackerConfig next = initial;
    next.sensor_feedback = false;
    EXPECT_FALSE(tuned.ask(next).sensor_feedback);
    ASSERT_TRUE(tuned.used);
    EXPECT_FALSE(tuned.used->odometry.sensor_feedback);
    EXPECT_EQ(tuned.used->run.keyframe_rate, initial.keyframe_rate);
  }
}

TEST(SettingsInForce, RefusesWhatTheStageWouldRefuse) {
  Tuned<TrackerStage> tuned;
  TrackerConfig wanted = TrackerConfig::__getDefault__();
  wanted.mapping_min_gradient = 0.5;
  EXPECT_EQ(tuned.ask(wanted).mapping_min_gradient, 3.0);
  wanted = TrackerConfig::__getDefault__();
  wanted.min_range = 6.0;  // beyond max_range
  EXPECT_EQ(tuned.ask(wanted).min_range, 0.4);
  EXPECT_FALSE(tuned.used);
}

class CameraReconfigurationTest : public ::testing::Test {
 protected:
  using Result = CameraSettingsInForce::Result;

  OpenNI2CameraConfig ask(OpenNI2CameraConfig config) {
    settings_.config().change(&config);
    return config;
  }

  std::vector<Result> used_;
  std::function<void()> before_use_ = [] {};
  CameraSettingsInForce settings_{[] { return DeviceDescription(); },
                                  [this](const Result& result) {
                                    before_use_();
                                    used_.push_back(result);
                                  }};
};

TEST_F(CameraReconfigurationTest, ATimeThatIsNoneIsRefusedAndTheRestIsTaken) {
  OpenNI2CameraConfig wanted = OpenNI2CameraConfig::__getDefault__();
  wanted.rgb_time_offset = 0.01;
  EXPECT_EQ(ask(wanted).rgb_time_offset, 0.01);
  wanted.rgb_time_offset = kNan;
  wanted.depth_time_offset = kInfinity;
  wanted.rgb_mode = "huge";
  wanted.mirror = true;
  const OpenNI2CameraConfig shown = ask(wanted);
  EXPECT_EQ(shown.rgb_time_offset, 0.01);
  EXPECT_EQ(shown.depth_time_offset, 0.0);
  EXPECT_EQ(shown.rgb_mode, "640x480@30");
  EXPECT_TRUE(shown.mirror);
  ASSERT_EQ(used_.size(), 2U);
  EXPECT_EQ(used_[1].rgb_time_offset, 0.01);
  EXPECT_EQ(used_[1].depth_time_offset, 0.0);
  EXPECT_TRUE(used_[1].settings.mirror);
}

TEST_F(CameraReconfigurationTest, ShowsWhatIsUsedWhateverIsThrown) {
  OpenNI2CameraConfig wanted = OpenNI2CameraConfig::__getDefault__();
  wanted.exposure = 300;
  const std::function<void()> failures[] = {[] { throw std::runtime_error("no"); }, [] { throw Other(); }};
  for (const auto& failure : failures) {
    before_use_ = failure;
    OpenNI2CameraConfig shown = wanted;
    EXPECT_NO_THROW(shown = ask(wanted));
    EXPECT_EQ(shown.exposure, 0);
  }
  EXPECT_TRUE(used_.empty());
}

}  // namespace
}  // namespace rgbd_sfm_fusion
