// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/Image.h>

#include <memory>
#include <optional>

#include "rgbd_sfm_fusion/input/rectification.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// @file
/// Tracker and fusion need the same images, converted and rectified. In one process they get the same
/// messages, and what one of them has made of a message is the other one's as well. These functions may be
/// called from any thread. What they return is not to be changed.

/// A rectifier that is shared by all who ask for the same one. Arguments and exceptions are Rectifier's.
std::shared_ptr<const Rectifier> sharedRectifier(const CameraCalibration& calibration,
                                                 const std::optional<CameraCalibration>& depth,
                                                 bool depth_is_rectified);

/// As prepareGrey().
GreyImage sharedGrey(const sensor_msgs::ImageConstPtr& colour,
                     const std::shared_ptr<const Rectifier>& rectifier);

/// As prepareDepth(). Empty if there is no image.
DepthImage sharedDepth(const sensor_msgs::ImageConstPtr& depth,
                       const std::shared_ptr<const Rectifier>& rectifier, double unit, double saturated);

}  // namespace rgbd_sfm_fusion
