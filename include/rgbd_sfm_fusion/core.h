// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The headers that other programs may use, without ROS. Other headers may change with any release. See
/// examples/.
#pragma once

#include "rgbd_sfm_fusion/types.h"  // images, stamps

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/sensor/depth_noise.h"  // Eq. 8: the sensor's noise

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"        // Eq. 5 to 7 and 9 to 12: one frame's depth
#include "rgbd_sfm_fusion/fusion/fusion_options.h"      // the options of fusion
#include "rgbd_sfm_fusion/odometry/odometry_options.h"  // the options of tracking and mapping
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"   // Eq. 3 and 4: poses, and depth of keyframes
#include "rgbd_sfm_fusion/pipeline/pipeline.h"          // all stages, on one pair of images after the other
#include "rgbd_sfm_fusion/settings/settings.h"          // the same settings by name, and from YAML files
