// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The files in config/ say what their comments say they do.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/settings/settings.h"

namespace rgbd_sfm_fusion {
namespace {

const std::string kConfigFolder = RGBD_SFM_FUSION_SOURCE_DIR "/config/";

bool names(const std::string& file, const std::string& setting) {
  std::ifstream stream(kConfigFolder + file);
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(setting + ":", 0) == 0) return true;
  }
  return false;
}

bool isSetByPreset(const Setting& setting) {
  Settings one, other;
  setting.set(one, setting.get(other));
  const std::string before = setting.get(one);
  DepthNoiseModel strange;
  strange.quadratic = strange.floor = strange.lateral_sigma = 0.0078125F;
  strange.common_scale_sigma = strange.common_offset_sigma = 0.0078125F;
  strange.min_range = strange.max_range = strange.far_bias_sigma = strange.saturated_depth = 0.0078125F;
  one.fusion.noise = strange;
  return setting.get(one) != before;
}

TEST(ShippedFiles, DefaultAndExpertAreWhatHoldsWithoutAFile) {
  const std::string everyday = kConfigFolder + "default.yaml", expert = kConfigFolder + "expert.yaml";
  for (const std::vector<std::string>& files :
       std::vector<std::vector<std::string>>{{everyday}, {expert}, {everyday, expert}, {expert, everyday}}) {
    Settings settings;
    ASSERT_NO_THROW(loadSettings(files, &settings));
    for (const Setting& setting : allSettings()) {
      EXPECT_EQ(setting.get(settings), setting.get(Settings())) << setting.name;
    }
  }
}

TEST(ShippedFiles, EverySettingIsInOneOfThemButThoseOfThePreset) {
  for (const Setting& setting : allSettings()) {
    const bool is_written = !isSetByPreset(setting);
    EXPECT_EQ(names("default.yaml", setting.name), is_written && setting.is_everyday) << setting.name;
    EXPECT_EQ(names("expert.yaml", setting.name), is_written && !setting.is_everyday) << setting.name;
  }
}

TEST(ShippedFiles, DefaultIsShortEnoughToBeRead) {
  const auto& table = allSettings();
  const auto count =
      std::count_if(table.begin(), table.end(), [](const Setting& s) { return s.is_everyday; });
  EXPECT_GE(count, 12);
  EXPECT_LE(count, 18);
}

TEST(ShippedFiles, PaperIsThePapersFusionOnAMonocularTracker) {
  Settings settings, paper;
  ASSERT_NO_THROW(loadSettings({kConfigFolder + "paper.yaml"}, &settings));
  EXPECT_FALSE(settings.odometry.sensor_feedback);
  paper.fusion = FusionOptions::paper();
  paper.fusion.gaussian.max_disagreement = 1.0;
  paper.odometry.sensor_feedback = false;
  paper.odometry.compensate_skew = false;
  paper.odometry.keyframe.max_distance = 0.2F;
  paper.odometry.estimate_readout = false;
  paper.odometry.estimate_depth_delay = false;
  paper.odometry.estimate_principal_point = false;
  paper.odometry.mapping.smooth_published = false;
  paper.odometry.mapping.follow_scatter = false;
  for (const Setting& setting : allSettings()) {
    EXPECT_EQ(setting.get(settings), setting.get(paper)) << setting.name;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
