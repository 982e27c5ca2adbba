// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/pipeline/frame_preparation.h"

namespace rgbd_sfm_fusion {

/// What structure from motion has made of a frame, and what fusing it needs.
struct MappedFrame {
  RgbdFrame frame;
  TrackingResult tracked;
  std::shared_ptr<const KeyframeMap> keyframe;  ///< the one that `tracked` names; null while not tracking
  std::shared_ptr<const KeyframeMap> map;       ///< after this frame's mapping; null while there is none
  bool restarted = false;                       ///< the stamp went back: all before it was forgotten
  double preparation_ms = 0.0;                  ///< [ms] conversion and rectification
  double tracking_ms = 0.0;                     ///< [ms]
  double mapping_ms = 0.0;                      ///< [ms]
};

struct PipelineResult {
  MappedFrame mapped;
  FusedFrame fused;
  double fusion_ms = 0.0;  ///< [ms]
};

/// The whole method on one frame after the other: rectify, track, map, fuse. A frame is tracked and fused
/// with the map as of the frame before; one that becomes a keyframe is fused with its own map.
///
/// Where a stamp goes back (a bag that loops), everything starts anew.
///
/// map() and fuse() share nothing that changes: they may run in two threads, each getting every frame in
/// order.
class Pipeline {
 public:
  /// @throws std::invalid_argument naming the option or field of camera_info that is out of range
  Pipeline(const CameraCalibration& calibration, const OdometryOptions& odometry,
           const FusionOptions& fusion);

  /// @param depth  the depth image that belongs to `colour`; empty: none does
  /// @throws std::invalid_argument for images of a wrong size or encoding
  PipelineResult process(const RawImage& colour, const RawImage& depth) { return fuse(map(colour, depth)); }

  /// Everything but the fusion. As process().
  MappedFrame map(const RawImage& colour, const RawImage& depth);

  PipelineResult fuse(MappedFrame mapped);

  /// Camera of the rectified images.
  const PinholeCamera& camera() const { return rectifier_.camera(); }
  const Rectifier& rectifier() const { return rectifier_; }

 private:
  Rectifier rectifier_;
  VisualOdometry odometry_;
  DepthFusion fusion_;
  std::shared_ptr<const KeyframeMap> map_;
  Stamp last_stamp_ = kNoStamp;
};

}  // namespace rgbd_sfm_fusion
