// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

namespace rgbd_sfm_fusion {

/// Path of a file or folder for one test. Several processes may run the tests at once, each of them a part.
inline std::string temporaryPath(const std::string& name) {
  return testing::TempDir() + std::to_string(getpid()) + "_" + name;
}

}  // namespace rgbd_sfm_fusion
