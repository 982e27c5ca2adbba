// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/settings/written_files.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace rgbd_sfm_fusion {
namespace {

std::string contents(const std::string& path) {
  std::ifstream stream(RGBD_SFM_FUSION_SOURCE_DIR "/" + path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(WrittenFiles, AreThoseOfThePackage) {
  const std::vector<WrittenFile> files = writtenFiles();
  EXPECT_EQ(files.size(), 5U);
  for (const WrittenFile& file : files) {
    EXPECT_TRUE(contents(file.path) == file.text)  // not EXPECT_EQ, which would print all of it
        << file.path << " is stale: `cmake --build BUILD --target write_settings`, then "
        << "BUILD/devel/lib/rgbd_sfm_fusion/write_settings PACKAGE_FOLDER";
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
