// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The values that tracking and mapping give each other. A FrameToMap goes from tracking to mapping, and a
/// KeyframeToTrack comes back. Neither value changes after it was handed over. Nothing else passes between
/// the two.
#pragma once

#include <cstdint>
#include <memory>

#include "rgbd_sfm_fusion/image/image_pyramid.h"
#include "rgbd_sfm_fusion/odometry/camera_pose.h"
#include "rgbd_sfm_fusion/odometry/odometry_options.h"
#include "rgbd_sfm_fusion/odometry/step.h"
#include "rgbd_sfm_fusion/tracking/depth_residuals.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"
#include "rgbd_sfm_fusion/tracking/tracking_reference.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// So many views are enough for a keyframe's stereo. If a keyframe has more frames, they are so near to each
/// other that each of them refines all pixels of some bands of rows only, and elsewhere those that are poorly
/// known: each band gets so many views or more. If it has fewer, they are far apart, and none may be wasted:
/// the next keyframe is a view of this one, and this one's views are views of the next one. After a start,
/// tracking waits for each frame's map until there were so many.
constexpr std::uint32_t kEnoughViews = 6;

/// A place that frames are aligned with: where a keyframe is, and what it shows. Of an earlier keyframe, this
/// is kept, for a camera that comes back.
struct Place {
  CameraPose pose;
  Step step;  ///< to the keyframe, from the frame before; once the next frame is known, the mean of that and
              ///< the step after, if both are known
  double mean_inverse_depth = 1.0;      ///< of the scene that it shows
  double reference_readout_time = 0.0;  ///< [s] by which the rows of `reference` were moved that the last
                                        ///< mapping has renewed. Frames are aligned with the same one
  DepthCells cells;  ///< of its sensor depth; empty: frames are not aligned with sensor depth
  TrackingReference reference;

  double sceneDepth() const { return 1.0 / mean_inverse_depth; }
};

/// The keyframe, at one of its revisions, for the frames that are tracked next.
struct KeyframeToTrack : Place {
  Stamp stamp = kNoStamp;
  std::uint32_t revision = 0;  ///< as in KeyframeMap; 0: also before that one is published
  PinholeCamera camera;        ///< that frames are aligned with
  double depth_delay = 0.0;    ///< [s] of depth images; frames are aligned with the same one
  cv::Mat_<float> coarse;      ///< its brightness, on TrackingOptions::middleLevel()
};

/// A tracked frame, for mapping.
struct FrameToMap {
  enum class Use : std::uint8_t {
    kRefines,                ///< a view for the keyframe's stereo
    kBecomesKeyframe,        ///< takes over the last keyframe's stereo and its depth for tracking
    kBecomesKeyframeAfresh,  ///< takes over no stereo, as that used another principal point; depth for
                             ///< tracking only to check new sensor depth, if there is, and
                             ///< to expect what that does not see
    kStarts,                 ///< becomes a keyframe, and takes over nothing
  };
  Use use = Use::kRefines;
  RgbdFrame rgbd;
  PinholeCamera camera;      ///< as learned up to this frame; for a keyframe that it becomes
  double depth_delay = 0.0;  ///< [s] likewise
  ImagePyramid pyramid;
  double pixel_noise = 0.0;      ///< [grey levels] ImageNoise::ofImage()
  cv::Mat_<std::uint8_t> fixed;  ///< FixedInView::squares()
  CameraPose pose;
  SE3 T_frame_keyframe;                  ///< from the keyframe that the frame refines or replaces
  Matrix6 covariance = Matrix6::Zero();  ///< of T_frame_keyframe, from alignment: left perturbation
  Brightness brightness;                 ///< relative to that keyframe
  Step step;
  double progress = 0.0;                           ///< from that keyframe to the next one, which is due at 1
  double readout_time = 0.0;                       ///< [s] as set, or as learned up to this frame
  double readout_sigma = 0.0;                      ///< [s] its standard deviation; 0: it is set
  std::shared_ptr<const OdometryOptions> options;  ///< in force at this frame

  ReadoutMotion motionDuringReadout(const Step& of_image) const { return {of_image.during(readout_time)}; }
};

}  // namespace rgbd_sfm_fusion
