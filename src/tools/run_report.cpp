// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/run_report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <utility>

#include "rgbd_sfm_fusion/tools/text_format.h"

namespace rgbd_sfm_fusion {
namespace {

const std::vector<std::string> kFileNames = {"trajectory.txt", "frames.csv",   "keyframes.csv",
                                             "timing.csv",     "summary.json", "settings.yaml"};
constexpr int kShareDecimals = 6;
constexpr int kTimeDecimals = 3;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string row(std::initializer_list<std::string> cells) {
  std::string text;
  for (const std::string& cell : cells) text += (text.empty() ? "" : ",") + cell;
  return text + "\n";
}

std::string share(double value) {
  return formatNumber(value, kShareDecimals);
}

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string frameRow(const MappedFrame& mapped, const FusedFrame& fused) {
  const TrackingResult& tracked = mapped.tracked;
  const bool tracking = tracked.state == TrackingState::kTracking;
  const Stamp depth_stamp = mapped.frame.depth_stamp;
  return row({formatStamp(tracked.stamp),
              toText(tracked.state),
              formatStamp(tracked.keyframe_stamp),
              tracking ? std::to_string(tracked.keyframe_revision) : "",
              tracked.relocalised ? "1" : "0",
              formatNumber(fused.scale.alpha, 9),
              formatNumber(fused.scale.sigma, 9),
              fused.scale.refused ? "1" : "0",
              std::to_string(fused.scale.inliers),
              formatNumber(fused.scale.residual, 9),
              std::to_string(fused.counts.total()),
              share(fused.counts.sensorOnlyShare()),
              share(fused.counts.sfmOnlyShare()),
              share(fused.counts.fusedShare()),
              share(ratio(fused.disagreeing, fused.counts.total())),
              formatNumber(depth_stamp == kNoStamp ? kNone : toSeconds(depth_stamp - tracked.stamp), 9),
              std::to_string(mapped.run),
              formatNumber(fused.state.offset, 9),
              formatNumber(fused.state.tilt.x(), 9),
              formatNumber(fused.state.tilt.y(), 9),
              formatNumber(fused.sigma_twice_as_far, 9),
              share(fused.counts.completedShare()),
              share(fused.counts.refilledShare())});
}

/// A line of comment, which readers of the format skip.
std::string startOfRun(std::uint32_t run) {
  return "# run " + std::to_string(run) +
         " starts here: stamps went back, so its poses do not continue those before\n";
}

std::size_t pixelsWithDepth(const KeyframeMap& keyframe) {
  return static_cast<std::size_t>(cv::countNonZero(keyframe.depth.mean == keyframe.depth.mean));
}

std::string jsonPercentiles(const char* stage, const std::vector<double>& values) {
  const Percentiles p = percentiles(values);
  return "    \"" + std::string(stage) + "\": {\"p50\": " + formatNumber(p.p50, kTimeDecimals) +
         ", \"p95\": " + formatNumber(p.p95, kTimeDecimals) +
         ", \"p99\": " + formatNumber(p.p99, kTimeDecimals) + "}";
}

std::string jsonText(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    constexpr char kFirstPrintable = 0x20;
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c >= 0 && c < kFirstPrintable ? ' ' : c;
  }
  return quoted + "\"";
}

/// Whether a setting may change results. `threads` never does.
bool isOfTheMethod(const Setting& setting) {
  return setting.name != "threads";
}

/// Lines of `"name": value` for the settings that are wanted.
std::string jsonSettings(const Settings& settings, const std::function<bool(const Setting&)>& is_wanted) {
  std::string text;
  for (const Setting& setting : allSettings()) {
    if (!isOfTheMethod(setting) || !is_wanted(setting)) continue;
    const bool is_number = setting.kind == Setting::Kind::kNumber || setting.kind == Setting::Kind::kInteger;
    const std::string value = setting.get(settings);
    text += (text.empty() ? "    " : ",\n    ") + jsonText(setting.name) + ": " +
            (is_number ? value : jsonText(value));
  }
  return text;
}

/// The default values of the settings that differ from them.
std::string jsonDefaults(const Settings& settings) {
  const Settings defaults;
  return jsonSettings(defaults,
                      [&](const Setting& setting) { return setting.get(settings) != setting.get(defaults); });
}

std::string jsonInput(const RunInput& input) {
  std::string bags;
  for (const std::string& bag : input.bags) bags += (bags.empty() ? "" : ", ") + jsonText(bag);
  const std::string duration =
      std::isfinite(input.duration) ? formatNumber(input.duration, kTimeDecimals) : "null";
  return "    \"bags\": [" + bags + "],\n    \"colour\": " + jsonText(input.colour) +
         ",\n    \"depth\": " + jsonText(input.depth) +
         ",\n    \"calibration\": " + jsonText(input.calibration) +
         ",\n    \"start\": " + formatNumber(input.start, kTimeDecimals) + ",\n    \"duration\": " + duration;
}

std::string settingsYaml(const Settings& settings) {
  std::string text = "# Settings of this run, for fuse_bag --config.\n";
  for (const Setting& setting : allSettings()) {
    if (isOfTheMethod(setting)) text += setting.name + ": " + setting.get(settings) + "\n";
  }
  return text;
}

}  // namespace

Percentiles percentiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return values[std::max<std::size_t>(rank, 1) - 1];
  };
  return {at(0.50), at(0.95), at(0.99)};
}

const std::vector<std::string>& RunReport::fileNames() {
  return kFileNames;
}

RunReport::RunReport(const std::string& folder, const Settings& settings, RunInput input)
    : settings_(settings),
      input_(std::move(input)),
      folder_(folder, PendingFolder::Existing::kAccept),
      trajectory_(files_.emplace_back(folder + "/" + kFileNames[0])),
      frames_(files_.emplace_back(folder + "/" + kFileNames[1])),
      keyframes_(files_.emplace_back(folder + "/" + kFileNames[2])),
      timing_(files_.emplace_back(folder + "/" + kFileNames[3])),
      summary_(files_.emplace_back(folder + "/" + kFileNames[4])),
      settings_file_(files_.emplace_back(folder + "/" + kFileNames[5])) {
  trajectory_.write("# timestamp tx ty tz qx qy qz qw\n");
  frames_.write(row({"stamp",
                     "state",
                     "keyframe",
                     "revision",
                     "relocalised",
                     "alpha",
                     "sigma_alpha",
                     "refused",
                     "inliers",
                     "residual",
                     "pixels_with_depth",
                     "sensor_only",
                     "sfm_only",
                     "fused",
                     "disagreement",
                     "skew",
                     "run",
                     "offset",
                     "tilt_x",
                     "tilt_y",
                     "sigma_twice_as_far",
                     "completed",
                     "refilled"}));
  keyframes_.write(
      row({"stamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw", "revisions", "pixels_with_depth", "run"}));
  timing_.write(row({"stamp", "preparation_ms", "tracking_ms", "mapping_ms", "fusion_ms"}));
}

void RunReport::add(const PipelineResult& result) {
  const MappedFrame& mapped = result.mapped;
  const TrackingResult& tracked = mapped.tracked;
  if (tracked.state == TrackingState::kTracking) {
    if (mapped.run != run_of_trajectory_) trajectory_.write(startOfRun(mapped.run));
    run_of_trajectory_ = mapped.run;
    trajectory_.write(formatStamp(tracked.stamp) + " " + formatPose(tracked.T_first_frame, ' ') + "\n");
  }
  frames_.write(frameRow(mapped, result.fused));
  timing_.write(
      row({formatStamp(tracked.stamp), formatNumber(mapped.preparation_ms, kTimeDecimals),
           formatNumber(mapped.tracking_ms, kTimeDecimals), formatNumber(mapped.mapping_ms, kTimeDecimals),
           formatNumber(result.fusion_ms, kTimeDecimals)}));
  const bool is_same_map = last_map_ && mapped.map && last_map_->stamp == mapped.map->stamp;
  if (last_map_ && (mapped.run != run_of_last_map_ || (mapped.map && !is_same_map))) writeKeyframe();
  if (mapped.map) {
    last_map_ = mapped.map;
    run_of_last_map_ = mapped.run;
  }

  ++frames_by_state_[static_cast<std::size_t>(tracked.state)];
  counts_ += result.fused.counts;
  disagreeing_ += result.fused.disagreeing;
  preparation_ms_.push_back(mapped.preparation_ms);
  tracking_ms_.push_back(mapped.tracking_ms);
  mapping_ms_.push_back(mapped.mapping_ms);
  fusion_ms_.push_back(result.fusion_ms);
}

void RunReport::writeKeyframe() {
  ++number_of_keyframes_;
  keyframes_.write(row({formatStamp(last_map_->stamp), formatPose(last_map_->T_first_keyframe, ','),
                        std::to_string(last_map_->revision), std::to_string(pixelsWithDepth(*last_map_)),
                        std::to_string(run_of_last_map_)}));
  last_map_.reset();
}

void RunReport::finish() {
  if (last_map_) writeKeyframe();
  summary_.write(summaryJson());
  settings_file_.write(settingsYaml(settings_));
  for (ResultFile& file : files_) file.close();
}

void RunReport::commit() {
  for (ResultFile& file : files_) file.commit();
  folder_.keep();
}

std::string RunReport::summaryJson() const {
  const auto [initialising, tracked, lost] = frames_by_state_;
  return "{\n  \"version\": " + jsonText(RGBD_SFM_FUSION_VERSION) + ",\n  \"input\": {\n" +
         jsonInput(input_) + "\n  },\n  \"frames\": " + std::to_string(initialising + tracked + lost) +
         ",\n  \"frames_tracked\": " + std::to_string(tracked) +
         ",\n  \"frames_lost\": " + std::to_string(lost) +
         ",\n  \"frames_initialising\": " + std::to_string(initialising) +
         ",\n  \"keyframes\": " + std::to_string(number_of_keyframes_) +
         ",\n  \"table_1\": {\"sensor_only\": " + share(counts_.sensorOnlyShare()) +
         ", \"sfm_only\": " + share(counts_.sfmOnlyShare()) + ", \"fused\": " + share(counts_.fusedShare()) +
         "},\n  \"completed\": " + share(counts_.completedShare()) +
         ",\n  \"refilled\": " + share(counts_.refilledShare()) +
         ",\n  \"disagreement\": " + share(ratio(disagreeing_, counts_.total())) + ",\n  \"settings\": {\n" +
         jsonSettings(settings_, [](const Setting&) { return true; }) +
         "\n  },\n  \"changed_settings\": {\n" + jsonDefaults(settings_) + "\n  },\n  \"timing_ms\": {\n" +
         jsonPercentiles("preparation", preparation_ms_) + ",\n" + jsonPercentiles("tracking", tracking_ms_) +
         ",\n" + jsonPercentiles("mapping", mapping_ms_) + ",\n" + jsonPercentiles("fusion", fusion_ms_) +
         "\n  }\n}\n";
}

std::string RunReport::summaryText() const {
  const auto [initialising, tracked, lost] = frames_by_state_;
  const auto percent = [](double value) { return formatNumber(100.0 * value, 1) + " %"; };
  return std::to_string(initialising + tracked + lost) + " frames: " + std::to_string(tracked) +
         " tracked, " + std::to_string(lost) + " lost, " + std::to_string(initialising) + " initialising; " +
         std::to_string(number_of_keyframes_) +
         " keyframes\nof the pixels with measured depth: sensor only " + percent(counts_.sensorOnlyShare()) +
         ", SfM only " + percent(counts_.sfmOnlyShare()) + ", fused " + percent(counts_.fusedShare()) +
         "\nof the pixels without sensor depth: refilled " + percent(counts_.refilledShare()) + "\n";
}

}  // namespace rgbd_sfm_fusion
