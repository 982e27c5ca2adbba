// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/run_summary.h"

#include <gtest/gtest.h>

namespace rgbd_sfm_fusion {
namespace {

TEST(RunSummary, SaysWhatCameOutAndStartsAnew) {
  RunSummary summary;
  EXPECT_EQ(summary.take(30.0), "") << "nothing came: others say why";
  FusedFrame fused;
  fused.counts.sensor_only = 60;
  fused.counts.sfm_only = 10;
  fused.counts.fused = 30;
  for (int i = 0; i < 90; ++i) summary.add(fused, i < 45 ? TrackingState::kLost : TrackingState::kTracking);
  const std::string text = summary.take(3.0);
  for (const char* part : {"90 frames", "30.0 per second", "50 % of them tracked",
                           "60 % is the sensor's alone", "10 % from motion alone", "30 % from both"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_EQ(summary.take(30.0), "");
}

}  // namespace
}  // namespace rgbd_sfm_fusion
