// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/input/depth_association.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/pipeline/frame_preparation.h"

namespace rgbd_sfm_fusion {

/// What structure from motion has made of a frame, and what fusing it needs.
struct MappedFrame {
  RgbdFrame frame;
  TrackingResult tracked;
  std::shared_ptr<const KeyframeMap> keyframe;  ///< the one that `tracked` names; null while not tracking
  std::shared_ptr<const KeyframeMap> map;       ///< after this frame's mapping; null: it was not mapped
  std::uint32_t run = kFirstRun;                ///< a change means that everything before was forgotten
  double preparation_ms = 0.0;                  ///< [ms] conversion and rectification
  double tracking_ms = 0.0;                     ///< [ms]
  double mapping_ms = 0.0;                      ///< [ms]
};

struct PipelineResult {
  MappedFrame mapped;
  FusedFrame fused;
  double fusion_ms = 0.0;  ///< [ms]
};

/// The whole method on one frame after the other: rectify, track, map, fuse. A frame is fused with the map
/// that its TrackingResult names. A frame that becomes a keyframe is fused with its own map.
///
/// Where the number of the run changes (time went back: a bag that loops), everything starts anew.
///
/// track(), map() and fuse() may run in three threads. Each has to get every frame in order. The results are
/// the same as in one thread.
class Pipeline {
 public:
  /// @param depth  calibration of the depth images, which may be of another size; none: it is not known
  /// @param depth_is_rectified  as for Rectifier
  /// @throws std::invalid_argument naming the option or field of camera_info that is out of range
  Pipeline(const CameraCalibration& calibration, const OdometryOptions& odometry, const FusionOptions& fusion,
           const std::optional<CameraCalibration>& depth = std::nullopt, bool depth_is_rectified = false);

  /// @param depth  the depth image that belongs to `colour`; empty: there is none
  /// @param run    as DepthAssociator gives it
  /// @throws std::invalid_argument for images of a wrong size or encoding, or a stamp that is not after the
  ///         one before it in the same run
  PipelineResult process(const RawImage& colour, const RawImage& depth, std::uint32_t run = kFirstRun) {
    return fuse(map(colour, depth, run));
  }

  /// Tracks a frame that prepareFrame() has made with rectifier(). Where map() runs in another thread, this
  /// waits for the map that the frame is to be tracked against.
  /// @return to be given to map()
  /// @throws std::invalid_argument for a stamp that is not after the one before it in the same run
  MappedFrame track(RgbdFrame frame, std::uint32_t run);

  /// Refines the map with a tracked frame, and finds the map to fuse the frame with.
  MappedFrame map(MappedFrame tracked);

  /// All steps but the fusion. Arguments and exceptions are as for process().
  MappedFrame map(const RawImage& colour, const RawImage& depth, std::uint32_t run = kFirstRun);

  PipelineResult fuse(MappedFrame mapped);

  const Rectifier& rectifier() const { return rectifier_; }

  /// Camera of the rectified images.
  const PinholeCamera& camera() const { return rectifier_.camera(); }

 private:
  Rectifier rectifier_;
  VisualOdometry odometry_;
  DepthFusion fusion_;
  double saturated_depth_;                               // [m]
  std::deque<std::shared_ptr<const KeyframeMap>> maps_;  // that frames may still name, in order
  std::uint32_t tracked_run_ = kFirstRun;
  std::uint32_t mapped_run_ = kFirstRun;
  std::uint32_t fused_run_ = kFirstRun;
};

}  // namespace rgbd_sfm_fusion
