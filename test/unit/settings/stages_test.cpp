// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The table of settings and the stages that use them agree on what is allowed, and on names.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/settings/settings.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

/// The sensor's range is the only setting that depends on another. Here it is so wide that it does not.
Settings withWideRange() {
  Settings settings;
  findSetting("min_range").set(settings, "0.001");
  findSetting("max_range").set(settings, "100");
  return settings;
}

/// The limits of a number; all values of other settings.
std::vector<double> outermostValues(const Setting& setting) {
  std::vector<double> values = {setting.minimum, setting.maximum};
  for (double index = 1.0; index < setting.maximum && !setting.choices.empty(); ++index)
    values.push_back(index);
  return values;
}

/// Values just outside the range, and NaN.
std::vector<double> forbiddenValues(const Setting& setting) {
  if (setting.kind == Setting::Kind::kInteger) return {setting.minimum - 1.0, setting.maximum + 1.0};
  if (setting.kind != Setting::Kind::kNumber) return {};
  const double little = 0.01 * (setting.maximum - setting.minimum);
  return {setting.minimum - little, setting.maximum + little, std::numeric_limits<double>::quiet_NaN(),
          std::numeric_limits<double>::infinity()};
}

/// Makes every stage, as at the start, and gives the settings to those that run, as reconfigure does.
void useInAllStages(const Settings& settings) {
  const PinholeCamera camera{160, 160, 150.0, 150.0, 79.5, 79.5};
  validate(settings);
  VisualOdometry(camera, settings.odometry);
  VisualOdometry(camera, {}).setOptions(settings.odometry);
  DepthFusion(camera, settings.fusion);
  DepthFusion(camera, {}).setOptions(settings.fusion);
  DepthAssociator<int, int> associator(settings.association);
}

std::string errorOf(const Settings& settings) {
  try {
    validate(settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Stages, TakeAllThatTheTableAllows) {
  for (const Setting& setting : allSettings()) {
    for (const double value : outermostValues(setting)) {
      Settings settings = withWideRange();
      ASSERT_NO_THROW(setting.set(settings, setting.textOf(value))) << setting.name << " = " << value;
      EXPECT_NO_THROW(useInAllStages(settings)) << setting.name << " = " << setting.textOf(value);
    }
  }
}

TEST(Stages, RefuseWhatTheTableRefusesAndSayWhichSettingItIs) {
  for (const Setting& setting : allSettings()) {
    for (const double value : forbiddenValues(setting)) {
      Settings settings = withWideRange();
      EXPECT_THROW(setting.setNumber(settings, value), std::invalid_argument) << setting.name << " " << value;
      setting.assign(settings, value);
      const std::string error = errorOf(settings);
      EXPECT_EQ(error.rfind(setting.name + " = ", 0), 0U) << setting.name << " = " << value << ": " << error;
    }
  }
}

TEST(Stages, SayOfSmallImagesWhatTheirUserCanChange) {
  const PinholeCamera camera{80, 60, 75.0, 75.0, 39.5, 29.5};
  try {
    VisualOdometry(camera, {});
    FAIL() << "80 x 60 pixels were taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()),
              "images of 80 x 60 pixels are too small to be tracked: expected 160 or more each way; choose a "
              "larger mode of the camera");
  }
}

TEST(Stages, KnowTheSameNoiseOfTheSensor) {
  int settings_of_noise = 0;
  for (const Setting& setting : allSettings()) {
    Settings settings;
    const double before = setting.value(settings);
    for (float DepthNoiseModel::*member :
         {&DepthNoiseModel::quadratic, &DepthNoiseModel::floor, &DepthNoiseModel::lateral_sigma,
          &DepthNoiseModel::common_scale_sigma, &DepthNoiseModel::common_offset_sigma,
          &DepthNoiseModel::min_range, &DepthNoiseModel::max_range, &DepthNoiseModel::far_bias_sigma,
          &DepthNoiseModel::saturated_depth}) {
      for (const double value : outermostValues(setting)) {
        setting.assign(settings, value);
        EXPECT_EQ(settings.fusion.noise.*member, settings.odometry.noise.*member) << setting.name;
        if (value != before && settings.fusion.noise.*member != Settings().fusion.noise.*member)
          ++settings_of_noise;
      }
    }
  }
  EXPECT_GE(settings_of_noise, 16);  // both limits of eight
}

TEST(Stages, TrackingGoesByTheNoiseThatIsSet) {
  const PlaneScene scene(smallCamera());
  const auto poseWith = [&](const char* setting, const char* value) {
    Settings settings;
    findSetting(setting).set(settings, value);
    EXPECT_TRUE(findSetting(setting).isTunableBy(SettingScope::kTracker)) << setting;
    VisualOdometry odometry(scene.camera(), settings.odometry);
    TrackingResult tracked;
    for (int i = 0; i < 3; ++i) {
      RgbdFrame frame = scene.frame(i * 33'000'000, motion(0.01 * i, 0.002 * i, 0.0), 2.0,
                                    static_cast<std::uint64_t>(i) + 1);
      frame.depth(cv::Rect(100, 80, 40, 40)) -= 0.2F;  // with steps around it
      tracked = odometry.track(frame);
      odometry.map();
    }
    EXPECT_EQ(tracked.state, TrackingState::kTracking) << setting;
    return tracked.T_first_frame.log();
  };
  const Vector6 usual = poseWith("noise_floor", "0.001");
  EXPECT_NE(poseWith("noise_floor", "0.05"), usual);
  EXPECT_NE(poseWith("noise_quadratic", "0.02"), usual);
  EXPECT_NE(poseWith("noise_lateral", "5"), usual);
  EXPECT_NE(poseWith("max_range", "2.05"), usual);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
