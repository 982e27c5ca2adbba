// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>

#include <memory>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/input/rectification.h"

namespace rgbd_sfm_fusion {

/// A fused frame, and what else is published of it.
struct FusionOutput {
  std_msgs::Header header;  ///< of the colour image
  FusedFrame fused;
  std::shared_ptr<const Rectifier> rectifier;  ///< of both images
  TrackingState state = TrackingState::kInitialising;
  DepthImage sensor;             ///< [m] rectified; empty: none was used
  Stamp depth_stamp = kNoStamp;  ///< of the depth image that was used
  double latency = 0.0;          ///< [s] since the colour image's stamp
};

}  // namespace rgbd_sfm_fusion
