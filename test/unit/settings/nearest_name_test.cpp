// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/settings/nearest_name.h"

#include <gtest/gtest.h>

namespace rgbd_sfm_fusion {
namespace {

TEST(EditDistance, CountsLettersToChange) {
  EXPECT_EQ(editDistance("", ""), 0U);
  EXPECT_EQ(editDistance("", "abc"), 3U);
  EXPECT_EQ(editDistance("abc", ""), 3U);
  EXPECT_EQ(editDistance("max_skew", "max_skew"), 0U);
  EXPECT_EQ(editDistance("max_skw", "max_skew"), 1U);
  EXPECT_EQ(editDistance("kitten", "sitting"), 3U);
}

TEST(EditDistance, IsTheSameBothWays) {
  const std::vector<std::string> words = {"", "a", "init", "inti", "threads", "close_gaps"};
  for (const std::string& a : words) {
    for (const std::string& b : words) EXPECT_EQ(editDistance(a, b), editDistance(b, a));
  }
}

TEST(NearestName, IsTheOneOfFewestChanges) {
  EXPECT_EQ(nearestName("inti", {"threads", "init", "splat"}), "init");
  EXPECT_EQ(nearestName("zz", {"ab", "cd"}), "ab");
}

}  // namespace
}  // namespace rgbd_sfm_fusion
