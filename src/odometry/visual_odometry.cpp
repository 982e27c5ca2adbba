// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "rgbd_sfm_fusion/mapping/semi_dense_mapper.h"
#include "rgbd_sfm_fusion/odometry/tracking_depth.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kMinStartPoints = 500;  // tracked points of the finest level that a start needs

double meanInverseDepth(const InverseDepthImage& depth) {
  double sum = 0.0;
  std::size_t count = 0;
  for (int v = 0; v < depth.mean.rows; ++v) {
    for (int u = 0; u < depth.mean.cols; ++u) {
      const float rho = depth.mean(v, u);
      sum += static_cast<double>(rho);
      count += rho > 0.0F ? 1U : 0U;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 1.0;
}

}  // namespace

class VisualOdometry::Implementation {
 public:
  Implementation(const PinholeCamera& camera, const OdometryOptions& options)
      : camera_(camera), options_(options), mapper_(camera), tracking_depth_(camera) {
    cameras_ = cameraPyramid(camera, options.tracking.pyramid_levels);
  }

  TrackingResult track(const RgbdFrame& frame) {
    frame_ = frame;
    pyramid_.build(frame.grey, options_.tracking.pyramid_levels);
    TrackingResult tracked;
    tracked.stamp = frame.stamp;
    if (!has_keyframe_) {
      start(tracked);
    } else {
      follow(tracked);
    }
    tracked_ = tracked;
    return tracked;
  }

  std::shared_ptr<const KeyframeMap> map() {
    if (tracked_.state != TrackingState::kTracking) return nullptr;
    if (tracked_.keyframe_stamp == tracked_.stamp) {
      makeKeyframe();
    } else {
      mapper_.observe({&pyramid_[0], tracked_.T_frame_keyframe, brightness_}, maxInverseDepth(),
                      options_.mapping);
      ++revision_;
    }
    updateReference();
    return publish();
  }

  void reset() {
    has_keyframe_ = false;
    tracked_ = TrackingResult();
    T_odom_keyframe_ = SE3();
    T_odom_frame_ = SE3();
    motion_ = SE3();
    brightness_ = Brightness();
  }

  void setOptions(const OdometryOptions& options) { options_ = options; }

 private:
  void start(TrackingResult& tracked) {
    if (frame_.depth.empty()) return;
    becomeKeyframe(tracked, T_odom_frame_);
    starting_ = true;
  }

  void becomeKeyframe(TrackingResult& tracked, const SE3& T_odom_frame) {
    tracked.state = TrackingState::kTracking;
    tracked.keyframe_stamp = tracked.stamp;
    tracked.keyframe_revision = 0;
    tracked.T_frame_keyframe = SE3();
    tracked.T_odom_frame = T_odom_frame;
  }

  void follow(TrackingResult& tracked) {
    const SE3 T_last_keyframe = T_odom_frame_.inverse() * T_odom_keyframe_;
    const SE3 predicted = motion_ * T_last_keyframe;
    const int coarse = std::max(options_.tracking.finest_level, options_.tracking.pyramid_levels - 2);
    const bool moving =
        alignmentCost(reference_, pyramid_, predicted, brightness_, options_.tracking, coarse) <
        alignmentCost(reference_, pyramid_, T_last_keyframe, brightness_, options_.tracking, coarse);
    const AlignmentResult result =
        align(reference_, pyramid_, moving ? predicted : T_last_keyframe, brightness_, options_.tracking);
    tracked.share_of_good_points = result.share_good;
    if (!result.converged ||
        result.share_good < static_cast<double>(options_.tracking.min_share_of_good_points)) {
      tracked.state = TrackingState::kLost;
      has_keyframe_ = false;
      motion_ = SE3();
      brightness_ = Brightness();
      return;
    }
    tracked.state = TrackingState::kTracking;
    tracked.keyframe_stamp = keyframe_stamp_;
    tracked.keyframe_revision = revision_;
    tracked.T_frame_keyframe = result.T_frame_keyframe;
    tracked.covariance = result.covariance;
    tracked.T_odom_frame = T_odom_keyframe_ * result.T_frame_keyframe.inverse();
    motion_ = tracked.T_odom_frame.inverse() * T_odom_frame_;
    T_odom_frame_ = tracked.T_odom_frame;
    brightness_ = result.brightness;

    const double distance = result.T_frame_keyframe.translation().norm() * mean_inverse_depth_ /
                            static_cast<double>(options_.keyframe.max_distance);
    const double lost = (1.0 - result.share_in_view) / static_cast<double>(options_.keyframe.max_lost);
    if (distance * distance + lost * lost > 1.0) {
      T_new_old_ = result.T_frame_keyframe;
      becomeKeyframe(tracked, T_odom_frame_);
    }
  }

  void makeKeyframe() {
    if (starting_) {
      mapper_.start(pyramid_[0], options_.mapping);
      tracking_depth_.clear();
    } else {
      mapper_.moveTo(pyramid_[0], T_new_old_, brightness_, options_.mapping);
      tracking_depth_.moveTo(T_new_old_);
    }
    if ((starting_ || options_.sensor_feedback) && !frame_.depth.empty())
      tracking_depth_.setSensor(frame_.depth);
    starting_ = false;
    has_keyframe_ = true;
    keyframe_stamp_ = frame_.stamp;
    keyframe_grey_ = frame_.grey.clone();
    T_odom_keyframe_ = tracked_.T_odom_frame;
    brightness_ = Brightness();
    revision_ = 0;
    reference_.setKeyframe(pyramid_, cameras_);
  }

  void updateReference() {
    stereo_ = mapper_.reliable(options_.mapping);
    const InverseDepthImage& depth = tracking_depth_.fuse(stereo_);
    if (revision_ == 0) mean_inverse_depth_ = meanInverseDepth(depth);
    reference_.setDepth(depth, options_.tracking.min_gradient, options_.tracking.finest_level);
  }

  std::shared_ptr<const KeyframeMap> publish() const {
    auto keyframe = std::make_shared<KeyframeMap>();
    keyframe->stamp = keyframe_stamp_;
    keyframe->revision = revision_;
    keyframe->camera = camera_;
    keyframe->T_odom_keyframe = T_odom_keyframe_;
    keyframe->grey = keyframe_grey_;
    keyframe->depth = toDepth(stereo_);
    return keyframe;
  }

  float maxInverseDepth() const {
    return static_cast<float>(mean_inverse_depth_) / options_.mapping.min_depth;
  }

  PinholeCamera camera_;
  OdometryOptions options_;
  std::vector<PinholeCamera> cameras_;

  // The frame that is being worked on.
  RgbdFrame frame_;
  ImagePyramid pyramid_;
  TrackingResult tracked_;
  bool starting_ = false;
  SE3 T_new_old_;  // of a frame that becomes a keyframe

  // Where the camera is.
  SE3 T_odom_frame_;
  SE3 motion_;             // T_frame_last
  Brightness brightness_;  // of the last frame, relative to the keyframe

  // The keyframe.
  bool has_keyframe_ = false;
  Stamp keyframe_stamp_ = kNoStamp;
  std::uint32_t revision_ = 0;
  GreyImage keyframe_grey_;
  SE3 T_odom_keyframe_;
  double mean_inverse_depth_ = 1.0;
  SemiDenseMapper mapper_;
  TrackingDepth tracking_depth_;
  InverseDepthImage stereo_;
  TrackingReference reference_;
};

VisualOdometry::VisualOdometry(const PinholeCamera& camera, const OdometryOptions& options)
    : implementation_(std::make_unique<Implementation>(camera, options)) {}
VisualOdometry::~VisualOdometry() = default;

TrackingResult VisualOdometry::track(const RgbdFrame& frame) {
  return implementation_->track(frame);
}
std::shared_ptr<const KeyframeMap> VisualOdometry::map() {
  return implementation_->map();
}
void VisualOdometry::reset() {
  implementation_->reset();
}
void VisualOdometry::setOptions(const OdometryOptions& options) {
  implementation_->setOptions(options);
}

}  // namespace rgbd_sfm_fusion
