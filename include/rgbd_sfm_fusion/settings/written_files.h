// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The package's files that list settings are written from the table, so that no name, range, default or
/// text stands in two places. They are cfg/Tracker.cfg and cfg/Fusion.cfg (dynamic reconfigure),
/// config/default.yaml, config/expert.yaml and docs/settings.md. `write_settings` writes them, and a test
/// fails if one is stale.
#pragma once

#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

struct WrittenFile {
  std::string path;  ///< in the package's folder
  std::string text;
};

std::vector<WrittenFile> writtenFiles();

}  // namespace rgbd_sfm_fusion
