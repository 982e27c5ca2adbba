// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>
#include <utility>

#include "rgbd_sfm_fusion/settings/settings.h"
#include "setting_kinds.h"

namespace rgbd_sfm_fusion {
namespace {

using setting_kinds::boolean;
using setting_kinds::choice;
using setting_kinds::number;

constexpr SettingScope kAtStart = SettingScope::kAtStart;
constexpr SettingScope kTracker = SettingScope::kTracker;
constexpr SettingScope kFusion = SettingScope::kFusion;
constexpr SettingScope kBoth = SettingScope::kTrackerAndFusion;

/// What users change: these are in config/default.yaml, all others in config/expert.yaml.
const std::set<std::string> kEveryday = {
    "sensor",
    "depth_scale",
    "max_skew",
    "init",
    "sensor_feedback",
    "estimate_readout",
    "readout_time",
    "estimate_depth_delay",
    "estimate_principal_point",
    "tracking_finest_level",
    "reject_reflections",
    "max_sfm_only_sigma",
    "min_inlier_probability",
    "complete",
    "publish_tf",
    "keyframe_rate",
    "points_decimation",
};

/// A preset: sets all of the sensor's noise at once.
Setting sensorPreset() {
  Setting setting = setting_kinds::describeChoice(
      {"kinect", "xtion", "astra"}, "sensor", kAtStart,
      "preset of the sensor's noise and range; the settings for these refine it");
  setting.value = [choices = setting.choices](const Settings& s) {
    return static_cast<double>(std::find(choices.begin(), choices.end(), s.sensor) - choices.begin());
  };
  setting.assign = [choices = setting.choices](Settings& s, double index) {
    s.sensor = choices.at(static_cast<std::size_t>(index));
    s.fusion.noise = s.odometry.noise = DepthNoiseModel::preset(s.sensor);
  };
  return setting;
}

/// A member of the sensor's noise model. Tracking and fusion share its value, and a preset sets it.
Setting noise(std::string name, std::string unit, double minimum, double maximum, SettingScope scope,
              std::string description, float DepthNoiseModel::*member) {
  Setting setting = number(
      std::move(name), std::move(unit), minimum, maximum, scope,
      std::move(description), [member](auto& s) -> auto& { return s.fusion.noise.*member; },
      [member](auto& s) -> auto& { return s.odometry.noise.*member; });
  setting.is_set_by_preset = true;
  return setting;
}

std::vector<Setting> sensorSettings() {
  return {
      sensorPreset(),
      noise("noise_quadratic", "1/m", 1e-6, 0.1, kBoth, "sigma of sensor depth Z is this times Z squared",
            &DepthNoiseModel::quadratic),
      noise("noise_floor", "m", 0.0, 0.1, kBoth, "sigma that rounding adds to sensor depth",
            &DepthNoiseModel::floor),
      noise("noise_lateral", "px", 0.0, 10.0, kBoth,
            "sigma of how far depth lies beside colour after registration; 0: single wild depths count, too",
            &DepthNoiseModel::lateral_sigma),
      // Tracking does not need it: an error that scales all depths alike only changes the unit of length.
      noise("common_scale_sigma", "", 0.0, 0.05, kFusion,
            "relative scale error that all sensor depth shares; fusing does not reduce it",
            &DepthNoiseModel::common_scale_sigma),
      noise("common_offset_sigma", "1/m", 0.0, 0.05, kFusion,
            "offset that all of the sensor's disparities share: an error of this times Z squared in all "
            "published depth",
            &DepthNoiseModel::common_offset_sigma),
      noise("min_range", "m", 0.001, 10.0, kBoth, "sensor depth that is nearer is not used",
            &DepthNoiseModel::min_range),
      noise("max_range", "m", 0.1, 100.0, kBoth,
            "largest depth that the sensor is specified for; farther depth is biased, and has no say in "
            "poses and scale",
            &DepthNoiseModel::max_range),
      noise(
          "far_bias_sigma", "1/m", 0.0, 0.05, kFusion,
          "beyond max_range all depth Z shares an error of this times Z squared; 0: depth beyond is not used",
          &DepthNoiseModel::far_bias_sigma),
      noise("saturated_depth", "m", 0.0, 100.0, kAtStart,
            "depth of the sensor's highest code, which means that nothing was measured; 0: there is no such "
            "code",
            &DepthNoiseModel::saturated_depth),
      number(
          "depth_scale", "m", 1e-6, 1.0, kAtStart,
          "metres per count of 16UC1 depth; 0.0002 for TUM's PNGs, 0.0001 for counts of 0.1 mm",
          [](auto& s) -> auto& { return s.run.depth_scale; }),
      number(
          "max_skew", "s", 0.0, 1.0, kAtStart, "depth farther from its colour image in time is not used",
          [](auto& s) -> auto& { return s.association.max_skew; }),
      number(
          "min_depth_period", "s", 0.0, 1.0, kAtStart,
          "depth images that come sooner after the one before are left out",
          [](auto& s) -> auto& { return s.association.min_depth_period; }),
      boolean(
          "compensate_skew", kBoth, "move sensor depth to the colour image's time by the tracked motion",
          [](auto& s) -> bool& { return s.odometry.compensate_skew; },
          [](auto& s) -> bool& { return s.fusion.compensate_skew; }),
  };
}

std::vector<Setting> trackerSettings() {
  return {
      choice(
          "init", {"depth", "random"}, kAtStart,
          "the map starts from the sensor's depth, or from random depth",
          [](auto& s) -> auto& { return s.odometry.init; }),
      boolean("sensor_feedback", kTracker,
              "with init: depth, track against sensor depth too, so that scale cannot drift",
              [](auto& s) -> bool& { return s.odometry.sensor_feedback; }),
      boolean("estimate_readout", kAtStart, "learn a rolling shutter's readout time from the images",
              [](auto& s) -> bool& { return s.odometry.estimate_readout; }),
      number(
          "readout_time", "s", -0.1, 0.1, kAtStart,
          "time from reading an image's first row to its last, negative if the last one is read first; "
          "estimate_readout starts from it",
          [](auto& s) -> auto& { return s.odometry.readout_time; }),
      boolean("estimate_depth_delay", kAtStart,
              "learn how much older depth images are than their stamps say, if compensate_skew and "
              "sensor_feedback are on",
              [](auto& s) -> bool& { return s.odometry.estimate_depth_delay; }),
      boolean("estimate_principal_point", kAtStart,
              "learn by how much the calibration's principal point is off, and track with what was learned",
              [](auto& s) -> bool& { return s.odometry.estimate_principal_point; }),
      number(
          "keyframe_distance", "", 0.01, 2.0, kTracker,
          "a frame so far from the keyframe, relative to the scene's depth, becomes a new one",
          [](auto& s) -> auto& { return s.odometry.keyframe.max_distance; }),
      number(
          "keyframe_lost", "", 0.01, 1.0, kTracker,
          "a frame that sees so much less of the keyframe (share) becomes a new one",
          [](auto& s) -> auto& { return s.odometry.keyframe.max_out_of_view; }),
      number(
          "tracking_finest_level", "", 0, 3, kAtStart,
          "how often the image is halved for the last step of tracking; 0 is full resolution. "
          "Half of 320 x 240 doubles the error of the trajectory",
          [](auto& s) -> auto& { return s.odometry.tracking.finest_level; }),
      number(
          "tracking_image_noise", "grey levels", 0.1, 50, kTracker,
          "largest sigma of a pixel's brightness in tracking, unless the image by itself has more; a smaller "
          "one is learned",
          [](auto& s) -> auto& { return s.odometry.tracking.image_noise; }),
      number(
          "tracking_min_gradient", "grey levels / px", 0.0, 50.0, kTracker,
          "least gradient of pixels that are tracked",
          [](auto& s) -> auto& { return s.odometry.tracking.min_gradient; }),
      number(
          "min_good_points", "", 0.0, 1.0, kTracker, "tracking is lost if a smaller share of points fits",
          [](auto& s) -> auto& { return s.odometry.tracking.min_share_of_good_points; }),
      number(
          "mapping_image_noise", "grey levels", 0.1, 50, kTracker, "sigma of a pixel's brightness in stereo",
          [](auto& s) -> auto& { return s.odometry.mapping.image_noise; }),
      number(
          "mapping_min_gradient", "grey levels / px", 1.0, 50.0, kTracker,
          "least gradient of pixels whose depth is estimated",
          [](auto& s) -> auto& { return s.odometry.mapping.min_gradient; }),
      number(
          "epipolar_noise", "px", 0.01, 5.0, kTracker, "sigma of an epipolar line's position",
          [](auto& s) -> auto& { return s.odometry.mapping.epipolar_noise; }),
      number(
          "max_mismatch", "sigma", 0.1, 20.0, kTracker, "largest difference in brightness of a stereo match",
          [](auto& s) -> auto& { return s.odometry.mapping.max_mismatch; }),
      number(
          "min_distinctness", "", 1.0, 10.0, kTracker,
          "a stereo match must be so much better than any other place on its line",
          [](auto& s) -> auto& { return s.odometry.mapping.min_distinctness; }),
      number(
          "min_observations", "", 2, 20, kTracker,
          "number of stereo observations that a published depth needs",
          [](auto& s) -> auto& { return s.odometry.mapping.min_observations; }),
      boolean("smooth_published", kTracker, "average published depth over neighbours within 4 px",
              [](auto& s) -> bool& { return s.odometry.mapping.smooth_published; }),
      boolean("follow_scatter", kTracker, "let SfM's variance follow how far stereo observations scatter",
              [](auto& s) -> bool& { return s.odometry.mapping.follow_scatter; }),
  };
}

std::vector<Setting> reprojectionSettings() {
  return {
      choice(
          "splat", {"nearest", "bilinear"}, kFusion, "where a point goes that falls between pixels",
          [](auto& s) -> auto& { return s.fusion.reprojection.splat; }),
      boolean("close_gaps", kFusion, "fill gaps of one pixel, and hide what shines through them",
              [](auto& s) -> bool& { return s.fusion.reprojection.close_gaps; }),
      boolean("pose_covariance", kFusion, "let the pose's uncertainty into the variance of SfM depth",
              [](auto& s) -> bool& { return s.fusion.reprojection.pose_covariance; }),
      number(
          "reprojection_lateral", "px", 0.0, 10.0, kFusion, "sigma of rounding to a pixel's centre",
          [](auto& s) -> auto& { return s.fusion.reprojection.lateral_sigma; }),
      number(
          "same_surface", "sigma", 0.1, 100.0, kFusion, "points that differ by less are of one surface",
          [](auto& s) -> auto& { return s.fusion.reprojection.same_surface; }),
      boolean("recent_keyframe", kFusion,
              "where the keyframe has no estimate, take the estimate of the keyframe before",
              [](auto& s) -> bool& { return s.fusion.recent_keyframe; }),
      number(
          "rim_width", "px", 0, 20, kFusion,
          "in the sensor's holes, SfM depth is not used so near to their rims",
          [](auto& s) -> auto& { return s.fusion.rim_width; }),
      boolean("reject_reflections", kFusion, "drop SfM depth of what is seen in mirrors and through panes",
              [](auto& s) -> bool& { return s.fusion.reject_reflections; }),
  };
}

std::vector<Setting> scaleSettings() {
  return {
      choice(
          "scale_estimator", {"mean_ratio", "least_squares", "weighted_robust"}, kFusion,
          "fit of SfM's scale to the sensor", [](auto& s) -> auto& { return s.fusion.scale.estimator; }),
      boolean("scale_sigma", kFusion, "count the scale's uncertainty; off: it is known exactly",
              [](auto& s) -> bool& { return s.fusion.scale.sigma_alpha; }),
      boolean("filter_scale", kFusion, "filter the scale over time; off: each frame's fit stands alone",
              [](auto& s) -> bool& { return s.fusion.scale.filter; }),
      number(
          "scale_min_pixels", "px", 1, 1e6, kFusion,
          "with fewer that have both depths, the fit of the scale is refused",
          [](auto& s) -> auto& { return s.fusion.scale.min_pixels; }),
      number(
          "scale_min_tiles", "", 4, 48, kFusion,
          "with fewer of the image's 8 x 6 tiles, the fit is refused, too",
          [](auto& s) -> auto& { return s.fusion.scale.min_tiles; }),
      number(
          "scale_min_inliers", "", 0.1, 0.9, kFusion,
          "the fit starts where so large a share of the pixels agrees best, and is refused if fewer fit",
          [](auto& s) -> auto& { return s.fusion.scale.min_inliers; }),
      number(
          "scale_sigma_floor", "", 0.0, 0.5, kFusion, "least relative sigma of a frame's fit",
          [](auto& s) -> auto& { return s.fusion.scale.sigma_floor; }),
      number(
          "scale_process_sigma", "1/sqrt(s)", 0.0, 10.0, kFusion,
          "random walk of the scale from keyframe to keyframe, relative",
          [](auto& s) -> auto& { return s.fusion.scale.process_sigma; }),
  };
}

std::vector<Setting> fusionSettings() {
  return {
      boolean("calibrate_sfm_variance", kFusion, "correct SfM's variance by what the sensor shows",
              [](auto& s) -> bool& { return s.fusion.calibrate_sfm_variance; }),
      boolean("test_agreement", kFusion, "keep one of two depths that disagree; off: always average",
              [](auto& s) -> bool& { return s.fusion.gaussian.test_agreement; }),
      number(
          "max_chi_squared", "", 0.1, 1e6, kFusion,
          "largest chi squared of two depths that count as agreeing",
          [](auto& s) -> auto& { return s.fusion.gaussian.max_chi_squared; }),
      number(
          "max_disagreement", "", 0.0, 1.0, kFusion,
          "where a larger share of the overlap disagrees, a frame's SfM depth is not used",
          [](auto& s) -> auto& { return s.fusion.gaussian.max_disagreement; }),
      number(
          "max_relative_sigma", "", 0.06, 0.2, kFusion, "SfM depth of a larger sigma / Z is not used",
          [](auto& s) -> auto& { return s.fusion.gaussian.max_relative_sigma; }),
      boolean("align_locally", kFusion,
              "before averaging, align SfM depth with sensor depth nearby; needs test_agreement",
              [](auto& s) -> bool& { return s.fusion.gaussian.align_locally; }),
      number(
          "max_sfm_only_sigma", "", 0.01, 0.2, kFusion,
          "SfM depth alone, and completed depth, is dropped where sigma / Z is larger",
          [](auto& s) -> auto& { return s.fusion.max_sfm_only_sigma; }),
      number(
          "min_inlier_probability", "", 0.0, 0.99, kFusion,
          "less probable SfM depth is not averaged, and dropped where it is alone; 0: not judged",
          [](auto& s) -> auto& { return s.fusion.gaussian.min_inlier_probability; }),
      boolean("complete", kFusion, "fill holes with what lies between measured depths of one surface",
              [](auto& s) -> bool& { return s.fusion.complete; }),
  };
}

std::vector<Setting> runSettings() {
  return {
      boolean("publish_tf", kAtStart, "publish tf from odom to the base frame",
              [](auto& s) -> bool& { return s.run.publish_tf; }),
      number(
          "keyframe_rate", "Hz", 0.1, 100.0, kTracker, "how often keyframes are sent to other processes",
          [](auto& s) -> auto& { return s.run.keyframe_rate; }),
      number(
          "queue_size", "", 1, 100, kAtStart,
          "number of images that may wait; if there are more, the oldest is dropped",
          [](auto& s) -> auto& { return s.run.queue_size; }),
      number(
          "threads", "", 1, 3, kAtStart, "number of threads of fuse_bag; the result is the same",
          [](auto& s) -> auto& { return s.run.threads; }),
      number(
          "points_decimation", "px", 1, 16, kFusion,
          "every n-th pixel of every n-th row becomes a point; nothing is averaged",
          [](auto& s) -> auto& { return s.run.points_decimation; }),
  };
}

std::vector<Setting> makeTable() {
  const std::pair<const char*, std::vector<Setting>> sections[] = {
      {"Sensor", sensorSettings()},
      {"Structure from motion", trackerSettings()},
      {"Reprojection of the keyframe's depth", reprojectionSettings()},
      {"Scale of SfM depth", scaleSettings()},
      {"Fusion", fusionSettings()},
      {"How it is run", runSettings()},
  };
  std::vector<Setting> table;
  for (const auto& [name, settings] : sections) {
    for (const Setting& setting : settings) {
      table.push_back(setting);
      table.back().section = name;
      table.back().is_everyday = kEveryday.count(setting.name) > 0;
    }
  }
  return table;
}

}  // namespace

const std::vector<Setting>& allSettings() {
  static const std::vector<Setting> table = makeTable();
  return table;
}

}  // namespace rgbd_sfm_fusion
