// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/pipeline/pipeline.h"
#include "rgbd_sfm_fusion/settings/settings.h"
#include "rgbd_sfm_fusion/tools/result_file.h"

namespace rgbd_sfm_fusion {

/// p50, p95 and p99 of a stage [ms].
struct Percentiles {
  double p50 = 0.0, p95 = 0.0, p99 = 0.0;
};

/// By the nearest rank; all 0 if there are no values.
Percentiles percentiles(std::vector<double> values);

/// What a run reads. It is kept for people who look at the results later.
struct RunInput {
  std::vector<std::string> bags;       ///< absolute paths
  std::string colour, depth;           ///< topics
  std::string calibration;             ///< topic, or the absolute path of a file
  double start = 0.0, duration = 0.0;  ///< [s]; infinite: to the end
};

/// The files of a run, in a folder: trajectory.txt, frames.csv, keyframes.csv, timing.csv, summary.json,
/// settings.yaml. They appear under their names when all are complete.
class RunReport {
 public:
  static const std::vector<std::string>& fileNames();

  /// Makes the folder if it is not there.
  /// @throws std::runtime_error naming what can't be written
  RunReport(const std::string& folder, const Settings& settings, RunInput input);

  /// @throws std::runtime_error e.g. when the disk is full
  void add(const PipelineResult& result);

  /// Writes the summary. @throws as add()
  void finish();
  /// Gives the files their names. @throws as add()
  void commit();

  /// For people: Table I and what was tracked.
  std::string summaryText() const;

 private:
  void writeKeyframe();
  std::string summaryJson() const;

  Settings settings_;
  RunInput input_;
  PendingFolder folder_;
  std::deque<ResultFile> files_;
  ResultFile& trajectory_;
  ResultFile& frames_;
  ResultFile& keyframes_;
  ResultFile& timing_;
  ResultFile& summary_;
  ResultFile& settings_file_;

  std::size_t frames_by_state_[3] = {};
  std::size_t number_of_keyframes_ = 0;
  std::uint32_t run_of_trajectory_ = kFirstRun;
  std::shared_ptr<const KeyframeMap> last_map_;
  std::uint32_t run_of_last_map_ = kFirstRun;
  ProvenanceCounts counts_;
  std::uint64_t disagreeing_ = 0;
  std::vector<double> preparation_ms_, tracking_ms_, mapping_ms_, fusion_ms_;
};

}  // namespace rgbd_sfm_fusion
