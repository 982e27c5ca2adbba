// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// What tracking and mapping give each other: a tracked frame goes to mapping, and what it has made of the
/// keyframe comes back. Neither is changed once it was handed over: nothing else passes between the two.
#pragma once

#include <cstdint>
#include <memory>

#include "rgbd_sfm_fusion/odometry/odom_pose.h"
#include "rgbd_sfm_fusion/odometry/odometry_options.h"
#include "rgbd_sfm_fusion/odometry/step.h"
#include "rgbd_sfm_fusion/tracking/depth_residuals.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"
#include "rgbd_sfm_fusion/tracking/image_pyramid.h"
#include "rgbd_sfm_fusion/tracking/tracking_reference.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// A keyframe after one of its refinements, as frames are tracked against it.
struct TrackedKeyframe {
  Stamp stamp = kNoStamp;
  std::uint32_t revision = 0;  ///< as in KeyframeMap
  OdomPose pose;
  Step step;                   ///< to the keyframe
  double readout_time = 0.0;   ///< [s] that its stereo began with
  double inverse_depth = 1.0;  ///< of what it shows, on average
  DepthCells cells;            ///< of its sensor depth; empty: not to be aligned with
  TrackingReference reference;

  double depth() const { return 1.0 / inverse_depth; }
};

/// A tracked frame, for mapping.
struct FrameToMap {
  enum class Use : std::uint8_t {
    kRefines,                ///< a view for the keyframe's stereo
    kBecomesKeyframe,        ///< and takes over what the keyframe before knows,
    kBecomesKeyframeAfresh,  ///< or only its depth for tracking: its stereo used another readout time
    kStarts,                 ///< a keyframe that does not hang together with the one before
  };
  Use use = Use::kRefines;
  RgbdFrame frame;
  ImagePyramid pyramid;
  OdomPose pose;
  SE3 T_frame_keyframe;   ///< the keyframe that it refines or replaces
  Brightness brightness;  ///< relative to that keyframe
  Step step;
  double readout_time = 0.0;                       ///< [s] as set, or as learned up to this frame
  double readout_sigma = 0.0;                      ///< [s] its standard deviation; 0: it is set
  std::shared_ptr<const OdometryOptions> options;  ///< in force at this frame

  ReadoutMotion readout(const Step& of_image) const { return {of_image.during(readout_time)}; }
};

}  // namespace rgbd_sfm_fusion
