// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Everything that users can set, by name: one table for YAML files, `--set`, ROS parameters and dynamic
/// reconfigure.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/input/depth_association.h"
#include "rgbd_sfm_fusion/odometry/odometry_options.h"

namespace rgbd_sfm_fusion {

/// What is no part of the method: how nodelets and tools run it.
struct RunOptions {
  bool publish_tf = true;      ///< tf from odom to the base frame
  double keyframe_rate = 2.0;  ///< [Hz] of keyframes sent to other processes
  int queue_size = 10;         ///< images that wait while one is worked on; then the oldest is dropped
  int threads = 2;             ///< of fuse_bag: 1 or 2
  int points_decimation = 1;   ///< [px] every n-th pixel of every n-th row becomes a point of /fusion/points
};

struct Settings {
  std::string sensor = "kinect";  ///< preset that `fusion.noise` was made from
  OdometryOptions odometry;
  FusionOptions fusion;
  AssociationOptions association;
  RunOptions run;
};

/// Who uses a setting, and whether it may change while that one runs.
enum class SettingScope { kAtStart, kTracker, kFusion, kTrackerAndFusion };

/// A row of the table.
struct Setting {
  std::string name;
  std::string unit;         ///< empty where there is none
  std::string description;  ///< one line
  SettingScope scope;       ///< kAtStart: not tunable at run time
  std::string range;        ///< what set() accepts, for people: `0 to 5`, `on or off`, `kinect or astra`

  std::function<std::string(const Settings&)> get;
  /// @throws std::invalid_argument naming setting, value and range; then nothing has changed
  std::function<void(Settings&, const std::string& value)> set;

  double minimum = 0.0;              ///< of a number
  double maximum = 0.0;              ///< of a number
  std::vector<std::string> choices;  ///< of a choice; empty for others
  enum class Kind { kNumber, kInteger, kBoolean, kChoice } kind;

  bool isTunableBy(SettingScope stage) const {
    return scope == stage || (scope == SettingScope::kTrackerAndFusion && stage != SettingScope::kAtStart);
  }
};

/// All settings; those that reset others (`sensor`) first.
const std::vector<Setting>& allSettings();

/// @throws std::invalid_argument when there is none of the name, with the nearest name and all others
const Setting& findSetting(const std::string& name);

/// Reads a YAML file of `name: value`. What it does not name keeps its value.
/// @throws std::invalid_argument naming the file, and the line where it is not understood
void loadSettings(const std::string& path, Settings* settings);

/// Applies `key=value`.
/// @throws std::invalid_argument as findSetting() and Setting::set()
void applyAssignment(const std::string& assignment, Settings* settings);

/// @throws std::invalid_argument where settings that are right each for itself contradict each other
void validate(const Settings& settings);

}  // namespace rgbd_sfm_fusion
