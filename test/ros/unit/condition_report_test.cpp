// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/condition_report.h"

#include <gtest/gtest.h>

namespace rgbd_sfm_fusion {
namespace {

using Sentences = std::vector<std::string>;

TEST(ConditionReport, SaysASentenceOnceWhateverItsNumbersAre) {
  ConditionReport report;
  EXPECT_EQ(report.worthSaying(0.0, {"depth is 45.1 ms away", "no scale"}),
            (Sentences{"depth is 45.1 ms away", "no scale"}));
  EXPECT_EQ(report.worthSaying(5.0, {"depth is 39 ms away", "no scale", "lost"}), Sentences{"lost"});
  EXPECT_EQ(report.worthSaying(130.0, {"depth is 39 ms away"}), Sentences{"depth is 39 ms away"})
      << "a reminder after two minutes";
  EXPECT_EQ(report.worthSaying(135.0, {}), Sentences{});
}

TEST(ConditionReport, SaysAgainWhatIsThereAgain) {
  ConditionReport report;
  EXPECT_EQ(report.worthSaying(0.0, {"no scale"}), Sentences{"no scale"});
  EXPECT_EQ(report.worthSaying(5.0, {}), Sentences{});
  EXPECT_EQ(report.worthSaying(10.0, {"no scale"}), Sentences{}) << "it comes and goes";
  EXPECT_EQ(report.worthSaying(20.0, {}), Sentences{});
  EXPECT_EQ(report.worthSaying(25.0, {"no scale"}), Sentences{"no scale"});
}

}  // namespace
}  // namespace rgbd_sfm_fusion
