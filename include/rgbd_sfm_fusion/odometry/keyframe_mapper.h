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
    std::shared_ptr<const KeyframeMap> map;           ///< to be published: stereo's depth
    std::shared_ptr<const KeyframeToTrack> to_track;  ///< all that the next frames need of the keyframe
  };

  // A frame is mapped in two parts, always in this order:
  /// The short part. Makes the frame the keyframe, with sensor depth and the depth that was known before it;
  /// or learns from the first frame after a keyframe how the camera went on. Does nothing for other frames.
  /// @param frame  the first one must have Use::kStarts
  /// @return the keyframe for tracking, if it is new or this is the first frame after it; else null
  std::shared_ptr<const KeyframeToTrack> mapWithoutStereo(const FrameToMap& frame);
  /// The long part: stereo between the keyframe and the frame, or for the frame that has become the keyframe.
  /// @param is_awaited  HandOver::isAwaited(): whether tracking waits for the result. If not, and the
  ///                    keyframe is new, tracking gets once more what mapWithoutStereo() has returned
  Result mapByStereo(const FrameToMap& frame, bool is_awaited);

 private:
  /// The data of one keyframe alone. There is no reset: a frame that starts makes all of it anew.
  struct Keyframe {
    Stamp stamp = kNoStamp;
    std::uint32_t revision = 0;
    GreyImage grey;
    cv::Mat_<float> coarse;    ///< as in KeyframeToTrack
    PinholeCamera camera;      ///< as known when this became the keyframe
    double depth_delay = 0.0;  ///< [s] likewise
    CameraPose pose;
    Step step;
    double mean_inverse_depth = 1.0;  ///< of the scene
    double parallax = 0.0;            ///< largest distance of a frame of its stereo, in depths of the scene
    double parallax_before = 0.0;     ///< `parallax` of the keyframe that its first stereo is from; else 0
    RgbdFrame sensor_frame;  ///< its frame, if it uses sensor depth; until learnStep(), to redo the skew
    TrackingDepth::Carried carried = TrackingDepth::Carried::kFillsGaps;  ///< for its sensor depth
    bool knows_step_after = false;  ///< whether the first frame after the keyframe was looked at
    DepthCells cells;
    StereoViews views;

    double knownParallax() const { return std::max(parallax, parallax_before); }
  };

  void makeKeyframe(const FrameToMap& frame);
  InverseDepthWarp warpTo(const FrameToMap& frame) const;
  void makeStereo(const FrameToMap& frame);
  void carryStereo(const FrameToMap& frame);
  void useSensorDepth(const FrameToMap& frame, Keyframe& next);
  void setSensorDepth(const FrameToMap& frame, double parallax, Keyframe& keyframe);
  RowBands refine(const FrameToMap& frame);
  bool learnStep(const FrameToMap& frame);
  RowBands bandsToRefine(const FrameToMap& frame) const;
  void observe(const FrameToMap& frame, const RowBands& bands);
  void fuse(const RowBands& bands, Keyframe& keyframe);
  std::shared_ptr<const KeyframeToTrack> toTrack(const FrameToMap& frame, const RowBands& bands,
                                                 const Keyframe& keyframe);
  std::shared_ptr<const KeyframeMap> toPublish(const FrameToMap& frame, const RowBands& bands);
  float maxInverseDepth(const FrameToMap& frame) const;

  cv::Size size_;
  ImagePool images_;
  Keyframe keyframe_;
  Keyframe next_;  // a frame that becomes keyframe_, from mapWithoutStereo() to mapByStereo()
  // These belong to a keyframe, too, but the next keyframe uses their memory again. Between the two parts,
  // semi_dense_ is still that of keyframe_, and the others, but for last_map_, are those of next_.
  SemiDenseMapper semi_dense_;
  InverseDepthImage stereo_depth_;  // semi_dense_'s estimates that can be relied on
  TrackingDepth tracking_depth_;
  bool carried_stereo_waits_ = false;  // for the next frame, until tracking_depth_ takes up stereo_depth_
  TrackingCandidates candidates_;
  SharedPool<KeyframeToTrack> to_track_pool_;
  SharedPool<KeyframeMap> map_pool_;
  // The last ones that were made: bands of rows that are not renewed are copied from them.
  std::shared_ptr<const KeyframeToTrack> last_to_track_ = std::make_shared<KeyframeToTrack>();
  std::shared_ptr<const KeyframeMap> last_map_;
};

}  // namespace rgbd_sfm_fusion
