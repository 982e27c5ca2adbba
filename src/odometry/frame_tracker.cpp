// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/frame_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "rgbd_sfm_fusion/image/image_border.h"
#include "rgbd_sfm_fusion/image/pixel_noise.h"
#include "rgbd_sfm_fusion/image_size.h"
#include "rgbd_sfm_fusion/odometry/alignment_verdict.h"
#include "rgbd_sfm_fusion/sensor/stray_depth.h"
#include "rgbd_sfm_fusion/tools/text_format.h"
#include "rgbd_sfm_fusion/tracking/tracking_candidates.h"

namespace rgbd_sfm_fusion {
namespace {

// [s] So long after the first usable image since a loss, the keyframe is looked for. Then a new start within
// a second is still possible.
constexpr double kLongestSearch = 0.9;
// If the camera's place is not recognised after a loss, the camera may have gone this far.
constexpr double kFarthestWhileLost = 0.5;  // [rad] and, round the scene, [depths of the scene]
constexpr double kJump = 0.01;  // [tracker units or rad] a pose that is found again farther away has jumped
constexpr float kDepthPairInflation = 2.0F;  // of a cell's sigma: neighbours' errors are alike

/// Variance of a pose that is defined, as filters take no singular covariance: what rounding leaves of it.
double noVariance() {
  constexpr double kRounding = std::numeric_limits<float>::epsilon();
  return kRounding * kRounding;
}

/// Whether tracking could use enough pixels to start: they have a gradient, and also depth if `needs_depth`.
/// There have to be enough of them in the smallest image, too. They lie along lines, so an image of half the
/// size has half of them.
bool hasEnoughPixels(const ImagePyramid& pyramid, const DepthImage& depth, bool needs_depth,
                     const GradientLimit& limit) {
  const cv::Mat_<float>& image = pyramid[0];
  const cv::Rect& seen = pyramid.seen(0);
  const float least = limit.onLevel(0);
  const int enough = kMinPoints << (pyramid.levels() - 1);
  int count = 0;
  for (int v = seen.y + 1; v + 1 < seen.br().y; ++v) {
    for (int u = seen.x + 1; u + 1 < seen.br().x; ++u) {
      const float gx = 0.5F * (image(v, u + 1) - image(v, u - 1)),
                  gy = 0.5F * (image(v + 1, u) - image(v - 1, u));
      const bool has_depth = !needs_depth || depth(v, u) > 0.0F;
      count += has_depth && gx * gx + gy * gy >= least * least ? 1 : 0;
    }
    if (count >= enough) return true;
  }
  return false;
}

}  // namespace

FrameTracker::FrameTracker(const PinholeCamera& camera, const OdometryOptions& options)
    : camera_(camera), calibration_(camera, options), fixed_({camera.width, camera.height}) {
  setOptions(options);
}

FrameTracker::Result FrameTracker::track(const RgbdFrame& frame,
                                         const std::shared_ptr<const KeyframeToTrack>& keyframe) {
  check(frame);
  last_stamp_ = frame.stamp;
  adopt(keyframe);
  Current current = prepare(frame);
  computeCells(frame);

  if (!follow(current)) startIfPossible(current);

  current.tracked.state = state_;
  calibration_.tell(current.tracked);
  if (keyframe_) current.tracked.depth_delay = depthDelay();
  current.tracked.share_fixed_in_view = fixed_.share();
  if (state_ != TrackingState::kTracking) return {current.tracked, nullptr};
  // What depends on the keyframe was set where the pose was found, in accept() or startAt().
  current.to_map->pose = pose_;
  current.to_map->pixel_noise = noise_.ofImage();
  current.to_map->fixed = fixed_.squares();
  current.to_map->step = step_;
  current.to_map->camera = calibration_.camera();
  current.to_map->depth_delay = calibration_.depthDelay();
  current.to_map->readout_time = current.tracked.readout_time;
  current.to_map->readout_sigma = current.tracked.readout_sigma;
  return {current.tracked, current.to_map};
}

void FrameTracker::reset() {
  last_stamp_ = kNoStamp;
  pose_ = CameraPose();
  pose_stamp_ = kNoStamp;
  step_ = Step();
  looking_since_ = kNoStamp;
  calibration_.reset(*options_);
  noise_ = ImageNoise(static_cast<double>(options_->tracking.image_noise));
  alike_ = Photometry().alike;
  fixed_.reset();
  adopt(nullptr);
}

bool FrameTracker::setOptions(const OdometryOptions& options) {
  const OdometryOptions before = options_ ? *options_ : OdometryOptions();
  options_ = std::make_shared<const OdometryOptions>(options);
  calibration_.setOptions(options);
  if (options.tracking.image_noise != before.tracking.image_noise)
    noise_ = ImageNoise(static_cast<double>(options.tracking.image_noise));
  const bool same_levels = options.tracking.pyramid_levels == before.tracking.pyramid_levels &&
                           options.tracking.finest_level == before.tracking.finest_level;
  return !same_levels;  // the keyframes' pyramids have other levels
}

void FrameTracker::check(const RgbdFrame& frame) const {
  requireSize("colour image", frame.grey, camera_);
  requireContinuous("colour image", frame.grey);
  if (!frame.seen.empty() && (frame.seen & cv::Rect({0, 0}, frame.grey.size())) != frame.seen)
    throw std::invalid_argument("`seen` reaches beyond the colour image: expected a part of it");
  if (!frame.depth.empty()) {
    requireSize("depth image", frame.depth, camera_);
    requireContinuous("depth image", frame.depth);
    if (frame.depth_stamp == kNoStamp)
      throw std::invalid_argument(
          "depth image without a stamp: expected a depth_stamp, which is that of the colour image if the two "
          "were taken together");
  }
  if (last_stamp_ != kNoStamp && frame.stamp <= last_stamp_) {
    throw std::invalid_argument("stamp " + formatStamp(frame.stamp) +
                                " s is not later than that of the frame before, " + formatStamp(last_stamp_) +
                                " s");
  }
}

FrameTracker::Current FrameTracker::prepare(const RgbdFrame& frame) {
  Current current{TrackingResult(), frames_.take()};
  ImagePyramid pyramid = std::move(current.to_map->pyramid);  // for its memory
  *current.to_map = FrameToMap();
  current.tracked.stamp = frame.stamp;
  current.to_map->rgbd = frame;
  current.to_map->options = options_;
  const cv::Rect seen = frame.seen.empty() ? cv::Rect({0, 0}, frame.grey.size()) : frame.seen;
  pyramid.build(frame.grey, options_->tracking.pyramid_levels, insideBorder(frame.grey, seen));
  noise_.look(pixelNoise(frame.grey, pyramid.seen(0)));
  current.to_map->pyramid = std::move(pyramid);
  return current;
}

void FrameTracker::computeCells(const RgbdFrame& frame) {
  if (keyframe_ && options_->feedsBack() && !frame.depth.empty())
    cells_.compute(frame.depth, keyframe_->camera, options_->noise);
  else
    cells_.clear();
  cells_.leaveOut(fixed_.squares());
}

/// Takes the keyframe that frames are aligned with from now on; null: the next one starts.
void FrameTracker::adopt(const std::shared_ptr<const KeyframeToTrack>& keyframe) {
  if (!keyframe) {
    state_ = TrackingState::kInitialising;  // again, if mapping the frame that started has failed
    earlier_keyframes_.clear();
  } else if (!keyframe_ || keyframe_->stamp != keyframe->stamp) {
    if (keyframe_) earlier_keyframes_.remember(*keyframe_);
    brightness_ = Brightness();
  }
  keyframe_ = keyframe;
  if (keyframe_) scene_depth_ = keyframe_->sceneDepth();
}

/// Aligns the frame with the keyframe. @return whether the frame shows what the keyframe shows
bool FrameTracker::follow(Current& current) {
  if (!keyframe_) return false;
  const SE3 T_last_keyframe = pose_.T_first_camera.inverse() * keyframe_->pose.T_first_camera;
  // An image is read out before the next one begins. Where stamps say less, as times of arrival do, the
  // camera would seem to race.
  const double interval =
      std::max(toSeconds(current.tracked.stamp - pose_stamp_), std::abs(keyframe_->reference_readout_time));
  if (interval > Step::kLongest) {  // the camera may be anywhere
    state_ = TrackingState::kLost;
    step_ = Step();
  }
  const double readout_share =
      interval <= Step::kLongest ? keyframe_->reference_readout_time / interval : 0.0;
  const AlignmentProblem problem{keyframe_->reference,
                                 current.to_map->pyramid,
                                 options_->tracking,
                                 {brightness_, noise_.sigma(), alike_},
                                 {T_last_keyframe, readout_share},
                                 depthPair(current.to_map->rgbd, interval)};
  const std::vector<SE3>& starts = guesses(T_last_keyframe, interval);
  AlignmentResult result = mayHaveTurned() ? alignFromFar(problem, starts) : align(problem, starts);
  if (isDoubtful(result) && !mayHaveTurned()) lookAround(problem, T_last_keyframe, result);
  current.tracked.share_of_good_points = result.share_good;
  const bool was_lost = state_ == TrackingState::kLost;  // at the frame before, or after a gap
  if (was_lost ? !isRecognised(result, options_->tracking) : !fits(result, options_->tracking)) {
    if (was_lost) step_ = Step();  // the first lost frame keeps it, for one more try
    state_ = TrackingState::kLost;
    return false;
  }
  current.tracked.relocalised =
      was_lost && hasJumped(keyframe_->pose.T_first_camera * result.T_frame_keyframe.inverse());
  step_ = was_lost ? Step() : Step{(result.T_frame_keyframe * T_last_keyframe.inverse()).log(), interval};
  calibration_.observe(problem, result, *keyframe_, step_);
  accept(problem, result, current);
  return true;
}

/// Something may be in front of the scene. Or the guesses have led to another place that looks alike, as they
/// may where the camera moves far between frames: then the frame fits better elsewhere.
void FrameTracker::lookAround(const AlignmentProblem& problem, const SE3& T_last_keyframe,
                              AlignmentResult& result) const {
  const AlignmentResult found = alignFromFar(problem, turned(T_last_keyframe, 2, keyframe_->sceneDepth()));
  if (agreement(found) > agreement(result)) result = found;
}

/// Says where an aligned frame is, and whether it becomes the keyframe.
void FrameTracker::accept(const AlignmentProblem& problem, const AlignmentResult& result, Current& current) {
  state_ = TrackingState::kTracking;
  looking_since_ = kNoStamp;
  brightness_ = result.photometry.brightness;
  noise_.observe(result.photometry.noise);
  alike_ = result.photometry.alike;
  current.tracked.keyframe_stamp = keyframe_->stamp;
  current.tracked.keyframe_revision = keyframe_->revision;
  current.tracked.T_frame_keyframe = result.T_frame_keyframe;
  current.tracked.covariance =
      poseCovariance(result, scaleSigma()) + calibration_.covariance(result, *keyframe_, step_);
  current.to_map->T_frame_keyframe = result.T_frame_keyframe;
  current.to_map->covariance = result.covariance;
  current.to_map->brightness = brightness_;
  setPose(keyframe_->pose.then(result.T_frame_keyframe, current.tracked.covariance), current);
  fixed_.observe(problem, result, *keyframe_, pose_.T_first_camera);
  // With feedback, it is to begin as at a start.
  const bool afresh = calibration_.contradicts(*keyframe_) && (!options_->feedsBack() || canStart(current));
  current.to_map->progress = progress(result);
  if (!afresh && (current.to_map->progress <= 1.0 || waitsForClearView(result))) return;
  markAsKeyframe(afresh ? FrameToMap::Use::kBecomesKeyframeAfresh : FrameToMap::Use::kBecomesKeyframe,
                 current);
}

/// Starts a keyframe with a frame that comes before the first one, or after a loss.
void FrameTracker::startIfPossible(Current& current) {
  if (!canStart(current)) return;
  if (keyframe_ && (startAtEarlierPlace(current) || keepLooking(current.tracked.stamp))) return;
  startAnew(current);
}

/// After a loss, the camera may see an earlier keyframe. A new keyframe then starts there from sensor depth,
/// which has the same scale as the earlier keyframe.
bool FrameTracker::startAtEarlierPlace(Current& current) {
  if (options_->init != Initialisation::kDepth) return false;
  const auto found =
      earlier_keyframes_.find(current.to_map->pyramid, options_->tracking, cells_, depthPairSigma());
  if (!found) return false;
  const AlignmentResult& aligned = found->aligned;
  const Place& place = *found->place;
  const CameraPose pose =
      place.pose.then(aligned.T_frame_keyframe, poseCovariance(aligned, scaleSigma()) +
                                                    calibration_.covariance(aligned, place, Step()));
  current.tracked.relocalised = hasJumped(pose.T_first_camera);
  startAt(pose, current);
  return true;
}

/// Starts the first keyframe, or a keyframe after a loss. All that is known about the latter is that it is
/// not far from the last pose.
void FrameTracker::startAnew(Current& current) {
  current.tracked.relocalised = hasPose();
  CameraPose pose = pose_;
  pose.covariance.diagonal() += unknownSinceLoss();
  startAt(pose, current);
}

/// Starts a keyframe that takes nothing over from the last one.
void FrameTracker::startAt(const CameraPose& pose, Current& current) {
  state_ = TrackingState::kTracking;
  looking_since_ = kNoStamp;
  step_ = Step();
  setPose(pose, current);
  markAsKeyframe(FrameToMap::Use::kStarts, current);
}

void FrameTracker::markAsKeyframe(FrameToMap::Use use, Current& current) {
  current.tracked.keyframe_stamp = current.tracked.stamp;
  current.tracked.keyframe_revision = 0;
  current.tracked.T_frame_keyframe = SE3();
  current.tracked.covariance = noVariance() * Matrix6::Identity();
  current.to_map->use = use;
}

void FrameTracker::setPose(const CameraPose& pose, Current& current) {
  current.tracked.T_first_frame = pose.T_first_camera;
  current.tracked.pose_covariance = pose.covariance;
  pose_ = pose;
  pose_stamp_ = current.tracked.stamp;
}

bool FrameTracker::canStart(const Current& current) const {
  const bool needs_depth = options_->init == Initialisation::kDepth;
  const DepthImage& measured = current.to_map->rgbd.depth;
  if (needs_depth && measured.empty()) return false;
  const DepthNoiseModel noise = options_->noise.withinRange();
  const DepthImage depth = needs_depth ? withNoise(sortStrays(measured, noise), noise).mean : DepthImage();
  return hasEnoughPixels(current.to_map->pyramid, depth, needs_depth,
                         {options_->tracking.min_gradient, noise_.ofImage()});
}

/// After a loss, a keyframe is looked for before a new one is started. The first call starts the clock.
bool FrameTracker::keepLooking(Stamp now) {
  if (looking_since_ == kNoStamp) looking_since_ = now;
  return toSeconds(now - looking_since_) < kLongestSearch;
}

/// Whether a pose is farther from the last one than the same place that was found again would be.
bool FrameTracker::hasJumped(const SE3& T_first_frame) const {
  return (pose_.T_first_camera.inverse() * T_first_frame).log().norm() > kJump;
}

/// Whether the next keyframe waits until nothing is in the way. At a low rate, the camera goes too far
/// meanwhile. With an unknown step, the rate is taken for a high one.
bool FrameTracker::waitsForClearView(const AlignmentResult& result) const {
  return isObstructed(result) && step_.interval <= Step::kShort;
}

/// From the keyframe to the next one: by distance, and by what has left the view.
double FrameTracker::progress(const AlignmentResult& result) const {
  const double distance = result.T_frame_keyframe.translation().norm() * keyframe_->mean_inverse_depth /
                          static_cast<double>(options_->keyframe.max_distance);
  const double out_of_view =
      (1.0 - result.share_in_view) / static_cast<double>(options_->keyframe.max_out_of_view);
  return std::hypot(distance, out_of_view);
}

/// [variances] How far the camera may have gone while lost. Almost zero for a first keyframe, which all poses
/// are relative to.
Vector6 FrameTracker::unknownSinceLoss() const {
  if (!hasPose()) return Vector6::Constant(noVariance());
  const double distance = kFarthestWhileLost * scene_depth_;
  Vector6 variances;
  variances << Eigen::Vector3d::Constant(distance * distance),
      Eigen::Vector3d::Constant(kFarthestWhileLost * kFarthestWhileLost);
  return variances;
}

/// Whether the camera may look anywhere: its velocity is forgotten, after two lost frames or a gap.
bool FrameTracker::mayHaveTurned() const {
  return state_ == TrackingState::kLost && !step_.isKnown();
}

/// The camera moves on as fast as it did, or has stopped. Or it may have turned.
const std::vector<SE3>& FrameTracker::guesses(const SE3& T_last_keyframe, double interval) {
  if (mayHaveTurned()) {
    guesses_ = turned(T_last_keyframe, 2, keyframe_->sceneDepth());
  } else {
    guesses_.assign({SE3::exp(step_.during(interval)) * T_last_keyframe, T_last_keyframe});
  }
  return guesses_;
}

/// Of the scale that a keyframe's depths share.
double FrameTracker::scaleSigma() const {
  return static_cast<double>(options_->noise.common_scale_sigma);
}

/// [1/tracker unit] Sigma of the difference between the inverse depths of two of the DepthCells.
float FrameTracker::depthPairSigma() const {
  return kDepthPairInflation * std::sqrt(2.0F) * options_->noise.quadratic;
}

/// [s] As of the keyframe's own depth.
double FrameTracker::depthDelay() const {
  return options_->compensate_skew ? keyframe_->depth_delay : 0.0;
}

DepthPair FrameTracker::depthPair(const RgbdFrame& frame, double interval) const {
  // Depth has a readout of its own, of which nothing is known: as little as of the colour camera's at first.
  if (cells_.empty() || keyframe_->cells.empty()) return {};
  if (interval > Step::kLongest) return {&keyframe_->cells, &cells_, 0.0, 0.0, depthPairSigma()};
  const double age = toSeconds(frame.stamp - frame.depth_stamp) + depthDelay();
  return {&keyframe_->cells, &cells_, age / interval, ReadoutEstimator::kStartSigma / interval,
          depthPairSigma()};
}

}  // namespace rgbd_sfm_fusion
