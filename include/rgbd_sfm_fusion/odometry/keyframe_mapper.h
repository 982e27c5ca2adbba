// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/image_pool.h"
#include "rgbd_sfm_fusion/mapping/semi_dense_mapper.h"
#include "rgbd_sfm_fusion/odometry/keyframe.h"
#include "rgbd_sfm_fusion/odometry/keyframe_map.h"
#include "rgbd_sfm_fusion/odometry/stereo_views.h"
#include "rgbd_sfm_fusion/odometry/tracking_depth.h"
#include "rgbd_sfm_fusion/shared_pool.h"
#include "rgbd_sfm_fusion/tracking/tracking_candidates.h"

namespace rgbd_sfm_fusion {

/// Maps what the camera sees. Owns the keyframe and its estimates. Tracked frames refine or replace the
/// keyframe.
class KeyframeMapper {
 public:
  explicit KeyframeMapper(const PinholeCamera& camera);

  struct Result {
    std::shared_ptr<const KeyframeMap> published;     ///< stereo's depth
    std::shared_ptr<const KeyframeToTrack> tracking;  ///< all that the next frames need of the keyframe
  };

  /// The short part of a frame's mapping, without stereo: makes a frame the keyframe, with sensor depth and
  /// the depth that was known before it; or learns from the first frame after a keyframe how the camera went
  /// on. To be called before map() for each frame.
  /// @param frame  the first one must have Use::kStarts
  /// @return the keyframe for tracking, if it is new or its motion was learned; else null
  std::shared_ptr<const KeyframeToTrack> begin(const FrameToMap& frame);

  /// The rest: stereo with the frame, or for the frame that has become the keyframe.
  /// @param is_awaited  whether the next frame is tracked against the result. If not, that of a new keyframe
  ///                    is what begin() has returned
  Result map(const FrameToMap& frame, bool is_awaited);

 private:
  /// The data of one keyframe alone. There is no reset: a frame that starts makes all of it anew.
  struct Keyframe {
    Stamp stamp = kNoStamp;
    std::uint32_t revision = 0;
    GreyImage grey;
    PinholeCamera camera;  ///< as known when this became the keyframe
    CameraPose pose;
    Step step;
    double readout_time = 0.0;  ///< [s] readout time that stereo began with
    double inverse_depth = 1.0;
    double parallax = 0.0, parallax_before = 0.0;  ///< largest distance of a frame from this keyframe, and
                                                   ///< from the one before, in depths of the scene
    RgbdFrame sensor;  ///< the keyframe's own frame with its depth, until the keyframe's motion is known
    bool knows_step_after = false;  ///< whether the first frame after the keyframe was looked at
    DepthCells cells;
    StereoViews views;

    double knownParallax() const { return std::max(parallax, parallax_before); }
  };

  void makeKeyframe(const FrameToMap& frame);
  InverseDepthWarp warpTo(const FrameToMap& frame) const;
  void makeStereo(const FrameToMap& frame);
  void carryStereo(const FrameToMap& frame);
  void setDepth(const FrameToMap& frame, Keyframe& next);
  void setSensorDepth(const FrameToMap& frame, Keyframe& keyframe);
  RowBands refine(const FrameToMap& frame);
  bool learnStep(const FrameToMap& frame);
  RowBands turnOf(const FrameToMap& frame) const;
  void observe(const FrameToMap& frame, const RowBands& bands);
  std::shared_ptr<const KeyframeToTrack> forTracking(const FrameToMap& frame, const RowBands& bands,
                                                     Keyframe& keyframe);
  void fuse(const RowBands& bands, Keyframe& keyframe);
  std::shared_ptr<const KeyframeToTrack> collectTracking(const FrameToMap& frame, const RowBands& bands,
                                                         const Keyframe& keyframe);
  std::shared_ptr<const KeyframeMap> published(const FrameToMap& frame, const RowBands& bands);
  float maxInverseDepth(const FrameToMap& frame) const;

  cv::Size size_;
  ImagePool images_;
  Keyframe keyframe_;
  Keyframe next_;  // between begin() and map() of the frame that becomes the keyframe
  // These belong to the keyframe, too, but the next keyframe uses their memory again.
  SemiDenseMapper semi_dense_;
  TrackingDepth tracking_depth_;
  InverseDepthImage stereo_depth_;  // the part of its estimates that can be relied on
  bool has_fused_stereo_ = true;    // as of the last map, into the depth for tracking
  TrackingCandidates candidates_;
  SharedPool<KeyframeToTrack> for_tracking_;
  SharedPool<KeyframeMap> maps_;
  // The last ones of keyframe_: bands of rows that are not renewed are copied from them.
  std::shared_ptr<const KeyframeToTrack> tracking_ = std::make_shared<KeyframeToTrack>();
  std::shared_ptr<const KeyframeMap> published_;
};

}  // namespace rgbd_sfm_fusion
