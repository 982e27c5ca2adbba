// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Everything that users can set, by name: one table for YAML files, `--set`, ROS parameters, dynamic
/// reconfigure and the documentation. written_files.h lists the files that are written from it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/input/depth_association.h"
#include "rgbd_sfm_fusion/odometry/odometry_options.h"

namespace rgbd_sfm_fusion {

/// How nodelets and tools run the method; not part of the method.
struct RunOptions {
  double depth_scale = 1e-3;   ///< [m] that one count of 16UC1 sensor depth stands for
  bool publish_tf = true;      ///< tf from odom to the base frame
  double keyframe_rate = 2.0;  ///< [Hz] of keyframes sent to other processes
  int queue_size = 10;  ///< so many images may wait while one is worked on; beyond that the oldest is dropped
  int threads = 3;      ///< of fuse_bag: 1 to 3
  int points_decimation = 1;  ///< [px] every n-th pixel of every n-th row becomes a point of /fusion/points
};

/// @throws std::invalid_argument naming the setting that is out of range
void validate(const RunOptions& options);

struct Settings {
  std::string sensor = "kinect";  ///< the preset from which the noise of `odometry` and `fusion` was made
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
  bool is_everyday = false;  ///< whether it is in config/default.yaml; the others are in expert.yaml
  bool is_set_by_preset =
      false;  ///< `sensor` sets it. It is in neither file, as a file that named it would undo the preset
  std::string unit;                             ///< empty where there is none
  std::string description;                      ///< one line
  SettingScope scope = SettingScope::kAtStart;  ///< kAtStart: not tunable at run time
  std::string range;  ///< what set() accepts, for people: `0 to 5`, `on or off`, `kinect or astra`
  std::vector<std::string> choices;  ///< for a choice; else empty
  double minimum = 0.0, maximum = 0.0;
  bool is_single_precision = false;

  /// The value as a number: 0 or 1 for a boolean, the index for a choice.
  std::function<double(const Settings&)> value;
  /// Checks nothing; use set() and setNumber() for numbers that come from outside.
  std::function<void(Settings&, double number)> assign;

  std::string get(const Settings& settings) const;
  std::string textOf(double number) const;
  bool accepts(double number) const;

  /// @throws std::invalid_argument naming setting, value and range; then nothing has changed
  void set(Settings& settings, const std::string& text) const;
  /// The same, for anything but a choice.
  void setNumber(Settings& settings, double number) const;

  bool isTunableBy(SettingScope stage) const {
    return scope == stage || (scope == SettingScope::kTrackerAndFusion && stage != SettingScope::kAtStart);
  }
};

/// All settings; those that reset others (`sensor`) first.
const std::vector<Setting>& allSettings();

/// @throws std::invalid_argument if none has the name; it lists the nearest name and all others
const Setting& findSetting(const std::string& name);

/// Reads YAML files of `name: value`, as if they were one file: later lines replace earlier ones, and a
/// preset never undoes what any of them says. Settings that they do not name keep their values.
/// @throws std::invalid_argument naming the file and the line that is not understood; then nothing has
///         changed
void loadSettings(const std::vector<std::string>& paths, Settings* settings);

/// Applies `key=value`.
/// @throws std::invalid_argument as findSetting() and Setting::set()
void applyAssignment(const std::string& assignment, Settings* settings);

/// Has each stage check its options.
/// @throws std::invalid_argument naming a setting that is out of range, or that contradicts another
void validate(const Settings& settings);

}  // namespace rgbd_sfm_fusion
