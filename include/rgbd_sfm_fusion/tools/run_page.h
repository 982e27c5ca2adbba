// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// The page of a run, which the script report_run makes of the run's files.
class RunPage {
 public:
  /// Asks report_run whether it has all that it needs and can write the page: better before a run than after.
  /// @param path   of the page
  /// @param truth  sequence with the truth; empty: none
  /// @throws std::runtime_error if it cannot; report_run has said why
  RunPage(std::string path, std::string truth);

  /// @param bag, results  what the run has written
  /// @throws std::runtime_error as above
  void make(const std::string& bag, const std::string& results) const;

  /// Topics that the page needs beyond those that a bag of results always has.
  static const std::vector<std::string>& topics();

 private:
  std::vector<std::string> withTruth(std::vector<std::string> words) const;

  std::string path_;
  std::string truth_;
  std::string program_;
};

}  // namespace rgbd_sfm_fusion
