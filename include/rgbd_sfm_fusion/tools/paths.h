// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rgbd_sfm_fusion {

/// Replaces a leading `~` by the home folder: no shell does that in `--option=~/file` or in launch files.
std::string withHome(const std::string& path);

/// The absolute path, with a leading `~` replaced by the home folder. A URL stays as it is.
std::string absolutePath(const std::string& path);

}  // namespace rgbd_sfm_fusion
