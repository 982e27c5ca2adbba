// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Everything that users can set, by name: one table for YAML files, `--set`, ROS parameters, dynamic
/// reconfigure and the documentation. What is written out of it: see written_files.h.
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
  double depth_scale = 1e-3;   ///< [m] of a count of sensor depth in 16UC1
  bool publish_tf = true;      ///< tf from odom to the base frame
  double keyframe_rate = 2.0;  ///< [Hz] of keyframes sent to other processes
  int queue_size = 10;         ///< images that wait while one is worked on; then the oldest is dropped
  int threads = 2;             ///< of fuse_bag: 1 or 2
  int points_decimation = 1;   ///< [px] every n-th pixel of every n-th row becomes a point of /fusion/points
};

/// @throws std::invalid_argument naming the setting that is out of range
void validate(const RunOptions& options);

struct Settings {
  std::string sensor = "kinect";  ///< preset that the noise of `odometry` and `fusion` was made from
  OdometryOptions odometry;
  FusionOptions fusion;
  AssociationOptions association;
  RunOptions run;
};

/// Who uses a setting, and whether it may change while that one runs.
enum class SettingScope { kAtStart, kTracker, kFusion, kTrackerAndFusion };

/// A row of the table.
struct Setting {
  enum class Kind { kNumber, kInteger, kBoolean, kChoice } kind = Kind::kNumber;
  std::string name;
  std::string section;       ///< heading in the files that list settings, e.g. `Sensor`
  bool is_everyday = false;  ///< in config/default.yaml; the others: in expert.yaml
  bool is_set_by_preset =
      false;                ///< by `sensor`: in neither file, as a file that named it would undo the preset
  std::string unit;         ///< empty where there is none
  std::string description;  ///< one line
  SettingScope scope = SettingScope::kAtStart;  ///< kAtStart: not tunable at run time
  std::string range;  ///< what set() accepts, for people: `0 to 5`, `on or off`, `kinect or astra`
  std::vector<std::string> choices;  ///< of a choice; empty for others
  double minimum = 0.0, maximum = 0.0;
  bool is_single_precision = false;

  /// As a number: 0 or 1 of a boolean, the index of a choice.
  std::function<double(const Settings&)> value;
  /// Whatever the number is; set() and setNumber() are for what comes from outside.
  std::function<void(Settings&, double number)> assign;

  std::string get(const Settings& settings) const;
  std::string textOf(double number) const;
  bool accepts(double number) const;

  /// @throws std::invalid_argument naming setting, value and range; then nothing has changed
  void set(Settings& settings, const std::string& text) const;
  /// The same of anything but a choice.
  void setNumber(Settings& settings, double number) const;

  bool isTunableBy(SettingScope stage) const {
    return scope == stage || (scope == SettingScope::kTrackerAndFusion && stage != SettingScope::kAtStart);
  }
};

/// All settings; those that reset others (`sensor`) first.
const std::vector<Setting>& allSettings();

/// @throws std::invalid_argument when there is none of the name, with the nearest name and all others
const Setting& findSetting(const std::string& name);

/// Reads YAML files of `name: value`, as if they were one file: later lines replace earlier ones, and a
/// preset never undoes what any of them says. What they do not name keeps its value.
/// @throws std::invalid_argument naming the file, and the line where it is not understood; then nothing has
///         changed
void loadSettings(const std::vector<std::string>& paths, Settings* settings);

/// Applies `key=value`.
/// @throws std::invalid_argument as findSetting() and Setting::set()
void applyAssignment(const std::string& assignment, Settings* settings);

/// What the stages themselves say of their options.
/// @throws std::invalid_argument naming a setting that is out of range, or that contradicts another
void validate(const Settings& settings);

}  // namespace rgbd_sfm_fusion
