// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Converts the messages between tracker and fusion. From the converted data, fusion gets the same result as
/// from the originals, bit by bit.
#pragma once

#include <rgbd_sfm_fusion/Keyframe.h>
#include <rgbd_sfm_fusion/TrackedFrame.h>

#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

namespace rgbd_sfm_fusion {

/// @param header       of the colour image
/// @param depth_stamp  of the sensor depth image that belongs to it, or kNoStamp
TrackedFrame toMessage(const std_msgs::Header& header, const TrackingResult& tracked, Stamp depth_stamp);

/// @throws std::invalid_argument for an unknown state, or a tracked frame with numbers that are not finite
TrackingResult fromMessage(const TrackedFrame& message);

/// Copies the images.
/// @param T_odom_first  from the axes of the first tracked image to those of the odom frame
KeyframePtr toMessage(const std_msgs::Header& header, const KeyframeMap& keyframe, const SE3& T_odom_first);

/// @param T_odom_first  as it was given to toMessage(); T_odom_firstOf() finds it
/// @return `depth` shares its pixels with the message; `grey` stays empty
/// @throws std::invalid_argument when sizes, encodings, camera matrix or pose are not as the message's
/// definition says
KeyframeMap fromMessage(const KeyframeConstPtr& message, const SE3& T_odom_first);

/// From the axes of the first tracked image, in which poses of frames are given, to those of the odom frame,
/// in which poses of keyframes are given.
/// @param tracked  a frame that was tracked against the keyframe
/// @throws std::invalid_argument if the keyframe's pose is invalid
SE3 T_odom_firstOf(const Keyframe& keyframe, const TrackingResult& tracked);

}  // namespace rgbd_sfm_fusion
