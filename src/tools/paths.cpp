// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/paths.h"

#include <cstdlib>
#include <filesystem>

namespace rgbd_sfm_fusion {

std::string withHome(const std::string& path) {
  if (path != "~" && path.rfind("~/", 0) != 0) return path;
  const char* home = std::getenv("HOME");
  return home == nullptr ? path : home + path.substr(1);
}

std::string absolutePath(const std::string& path) {
  if (path.find("://") != std::string::npos) return path;
  return std::filesystem::absolute(withHome(path)).lexically_normal().string();
}

}  // namespace rgbd_sfm_fusion
