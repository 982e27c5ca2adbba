// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/depth_fusion.h"

#include <cmath>
#include <optional>
#include <utility>

#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"
#include "rgbd_sfm_fusion/fusion/reflections.h"
#include "rgbd_sfm_fusion/fusion/reprojection.h"
#include "rgbd_sfm_fusion/fusion/sfm_points.h"
#include "rgbd_sfm_fusion/image_size.h"
#include "rgbd_sfm_fusion/option_check.h"
#include "rgbd_sfm_fusion/sensor/stray_depth.h"

namespace rgbd_sfm_fusion {
namespace {

void validate(const PinholeCamera& camera) {
  requireInRange("camera width", camera.width, 8, 1 << 14);
  requireInRange("camera height", camera.height, 8, 1 << 14);
  requireInRange("camera fx", camera.fx, 1e-3, 1e6);
  requireInRange("camera fy", camera.fy, 1e-3, 1e6);
  requireInRange("camera cx", camera.cx, -1e6, 1e6);
  requireInRange("camera cy", camera.cy, -1e6, 1e6);
}

bool isFinite(const SE3& T) {
  return T.translation().allFinite() && T.rotation().coeffs().allFinite();
}

/// Whether there is a pose, and `keyframe` is the keyframe that the pose refers to.
bool isUsable(const TrackingResult& tracked, const KeyframeMap* keyframe) {
  return tracked.state == TrackingState::kTracking && keyframe != nullptr &&
         keyframe->stamp == tracked.keyframe_stamp && isFinite(tracked.T_frame_keyframe) &&
         isFinite(tracked.T_first_frame) && tracked.covariance.allFinite();
}

/// The factor from SfM's depth to the sensor's where the two overlap: α, corrected by b. α alone may be some
/// per cent off, and b makes up for it.
ScaleEstimate scaleOf(const SfmState& state, const ScaleEstimate& fit) {
  const double inverse_depth = state.overlap_inverse_depth;
  const double in_overlap = inverse_depth > 0.0 ? 1.0 - state.offset / inverse_depth : 1.0;
  ScaleEstimate scale = fit;
  scale.alpha = state.alpha * in_overlap;
  const double variance = inverse_depth > 0.0 ? state.variance(scale.alpha * inverse_depth, 0.0, 0.0) /
                                                    (inverse_depth * inverse_depth)
                                              : state.covariance(0, 0);
  scale.sigma = scale.alpha * std::sqrt(variance);
  return scale;
}

/// Whether the two depths contradict each other in much of the overlap: then pose or map is wrong. Pixels
/// that are averaged or flagged are counted. The state is no test of it, since the state follows the overlap
/// of every frame.
/// @param min_pixels  fewer pixels say nothing about the frame as a whole
bool mostlyDisagrees(const FusedDepth& result, double max_disagreement, int min_pixels) {
  const std::uint64_t judged = result.counts.fused + result.disagreeing;
  const double share = static_cast<double>(result.disagreeing) / static_cast<double>(judged);
  return judged >= static_cast<std::uint64_t>(min_pixels) && share > max_disagreement;
}

}  // namespace

FusionOptions FusionOptions::paper() {
  FusionOptions options;
  options.noise.floor = 0.0f;
  options.noise.lateral_sigma = 0.0f;
  options.noise.common_scale_sigma = 0.0f;
  options.noise.common_offset_sigma = 0.0f;
  options.noise.far_bias_sigma = 0.0f;
  options.compensate_skew = false;
  options.reprojection.close_gaps = false;
  options.reprojection.pose_covariance = false;
  options.reprojection.lateral_sigma = 0.0f;
  options.recent_keyframe = false;
  options.reject_reflections = false;
  options.rim_width = 0;
  options.scale.estimator = ScaleEstimatorKind::kMeanRatio;
  options.scale.sigma_alpha = false;
  options.scale.filter = false;
  options.calibrate_sfm_variance = false;
  options.gaussian.test_agreement = false;
  options.gaussian.align_locally = false;
  options.gaussian.min_inlier_probability = 0.0;
  options.complete = false;
  return options;
}

void validate(const FusionOptions& options) {
  validate(options.noise);
  requireInRange("reprojection_lateral", options.reprojection.lateral_sigma, 0.0f, 10.0f);
  requireInRange("same_surface", options.reprojection.same_surface, 0.1f, 100.0f);
  requireInRange("rim_width", options.rim_width, 0, 20);
  requireInRange("scale_min_pixels", options.scale.min_pixels, 1, 1000000);
  requireInRange("scale_min_tiles", options.scale.min_tiles, 4, 48);
  requireInRange("max_sfm_only_sigma", options.max_sfm_only_sigma, 0.01, 0.2);
  requireInRange("scale_min_inliers", options.scale.min_inliers, 0.1, 0.9);
  requireInRange("scale_sigma_floor", options.scale.sigma_floor, 0.0, 0.5);
  requireInRange("scale_process_sigma", options.scale.process_sigma, 0.0, 10.0);
  requireInRange("max_chi_squared", options.gaussian.max_chi_squared, 0.1, 1e6);
  requireInRange("max_disagreement", options.gaussian.max_disagreement, 0.0, 1.0);
  requireInRange("max_relative_sigma", options.gaussian.max_relative_sigma, 0.06, 0.2);
  requireInRange("min_inlier_probability", options.gaussian.min_inlier_probability, 0.0, 0.99);
}

DepthFusion::DepthFusion(const PinholeCamera& camera, const FusionOptions& options)
    : camera_(camera), options_(options) {
  validate(camera);
  rgbd_sfm_fusion::validate(options);
  moved_.create(camera.height, camera.width);
}

FusedFrame DepthFusion::fuse(const TrackingResult& tracked,
                             const std::shared_ptr<const KeyframeMap>& keyframe, const RgbdFrame& frame) {
  const bool usable = isUsable(tracked, keyframe.get());
  if (usable) validate(keyframe->camera);
  if (usable) requireSize("keyframe depth", keyframe->depth.mean, camera_);
  if (usable) requireSize("keyframe variance", keyframe->depth.variance, camera_);
  if (usable) requireSize("keyframe depth", keyframe->depth.mean, keyframe->camera, "its camera's");
  if (!frame.depth.empty()) requireSize("sensor depth", frame.depth, camera_);
  if (!frame.grey.empty()) requireSize("brightness", frame.grey, camera_);
  requireContinuous("sensor depth", frame.depth);
  requireContinuous("brightness", frame.grey);

  FusedFrame fused;
  std::vector<cv::Rect> mirrors;
  fused.stamp = frame.stamp;
  updateSensorDepth(tracked, frame);  // Eq. 8: σ_Z, and what it lacks
  if (tracked.relocalised) previous_keyframe_.reset();
  points_.clear();
  if (usable) {
    const GaussianDepth keyframe_depth =
        options_.recent_keyframe
            ? previous_keyframe_.fillGaps(tracked, keyframe, options_.reprojection, pool_)
            : keyframe->depth;
    const GaussianDepth images{pool_.take<float>(keyframe_depth.mean.size()),
                               pool_.take<float>(keyframe_depth.mean.size())};
    const GaussianDepth sfm = reproject(keyframe_depth, keyframe->camera, tracked.T_frame_keyframe,
                                        tracked.covariance, options_.reprojection, images);  // Eq. 5 to 7
    if (sfm.mean.data != images.mean.data) {  // without motion, they are the keyframe's
      sfm.mean.copyTo(images.mean);
      sfm.variance.copyTo(images.variance);
    }
    points_.collect(sfm, sensor_);
    fused.scale = updateState(keyframe->stamp, frame.stamp);  // α, b and c in place of Eq. 9 and 10; or these
    if (!fused.scale.refused) squared_spread_.remember(fused.scale.spread * fused.scale.spread);
    if (fused.scale.hasScale()) {
      alignPoints();  // to metres: α μ, where b and c are zero
      cv::Mat_<std::uint8_t> measured = pool_.take<std::uint8_t>(keyframe_depth.mean.size());
      markMeasured(sensor_.depth.mean, measured);
      if (options_.reject_reflections)
        mirrors = dropReflections(camera_, sensor_.depth.mean, measured, points_);
      fused.sfm = images;
      points_.dropAndWrite(markUnsupported(frame.grey, measured), &fused.sfm);
    } else {
      points_.clear();
    }
  } else {
    fused.scale = scaleOf(state_filter_.stateAt(frame.stamp, options_.scale), {});
  }
  fused.state = state_filter_.state();
  fused.sigma_twice_as_far = fused.state.sigmaTwiceAsFar(options_.noise);
  FusedDepth& result = fused;  // this part of it is replaced
  result = rgbd_sfm_fusion::fuse(sensor_, points_, options_.gaussian, takeBuffer(),
                                 gainOfSensorOffset());  // Eq. 11, 12
  fused.sfm_rejected = options_.gaussian.test_agreement &&
                       mostlyDisagrees(result, options_.gaussian.max_disagreement, options_.scale.min_pixels);
  if (fused.sfm_rejected) {
    result = sensorAlone(sensor_, result, takeBuffer());
    mirrors.clear();  // they were found by SfM's depth
  }
  const bool judges = options_.gaussian.min_inlier_probability > 0.0 && usable && fused.scale.hasScale();
  if (judges && !fused.sfm_rejected) {  // a wrong pose says nothing of depth in other frames
    other_surfaces_.observe(points_, fused.sfm.mean, sensor_);
    judgeSfmOnly(points_, fused.sfm.mean, other_surfaces_,
                 {options_.gaussian.min_inlier_probability, options_.max_sfm_only_sigma}, result);
  }
  complete(frame.grey, mirrors, &fused);
  takeStrays(sensor_, &fused);
  return fused;
}

FusedDepth DepthFusion::takeBuffer() {
  const cv::Size size(camera_.width, camera_.height);
  FusedDepth buffer;
  buffer.depth = {pool_.take<float>(size), pool_.take<float>(size)};
  buffer.provenance = pool_.take<std::uint8_t>(size);
  buffer.disagreement = pool_.take<std::uint8_t>(size);
  return buffer;
}

SensorOffsetGain DepthFusion::gainOfSensorOffset() const {
  const Eigen::Vector4d& by_offset = state_filter_.state().by_sensor_offset;
  const double x = by_offset(2) / camera_.fx, y = by_offset(3) / camera_.fy;
  const double base = by_offset(1) - x * camera_.cx - y * camera_.cy;
  return {static_cast<float>(base), static_cast<float>(x), static_cast<float>(y),
          static_cast<float>(-by_offset(0))};
}

void DepthFusion::complete(const GreyImage& grey, const std::vector<cv::Rect>& mirrors, FusedFrame* fused) {
  fused->counts.without = fused->provenance.total() - fused->counts.total();
  if (!options_.complete || grey.empty()) return;
  if (fused->sfm_rejected) points_.clear();
  const SfmState& state = fused->state;
  const CommonVariance common = [&](double rho, double u, double v) {
    const double x = (u - camera_.cx) / camera_.fx, y = (v - camera_.cy) / camera_.fy;
    const double sfm_rho = state.alpha * (rho - state.inverseDepth(0.0, x, y));  // as in the tracker's map
    return state.variance(sfm_rho, x, y) + state.field_variance;
  };
  fused->counts.completed =
      completion_.complete({grey, sensor_.depth, points_, mirrors, options_.max_sfm_only_sigma,
                            static_cast<float>(camera_.fx), common, fused->depth, fused->provenance});
  fused->counts.without -= fused->counts.completed;
}

void DepthFusion::updateSensorDepth(const TrackingResult& tracked, const RgbdFrame& frame) {
  const StampedPose previous = last_pose_;
  const bool tracking = tracked.state == TrackingState::kTracking && isFinite(tracked.T_first_frame);
  if (tracking) last_pose_ = {frame.stamp, tracked.T_first_frame};
  DepthImage depth = frame.depth;
  if (depth.empty()) {
    depth = DepthImage(camera_.height, camera_.width, kNoDepth);
  } else if (options_.compensate_skew && tracking && !tracked.relocalised && frame.depth_stamp != kNoStamp) {
    const SE3 motion =
        motionSinceDepth(previous, last_pose_, frame.depth_stamp - fromSeconds(tracked.depth_delay));
    // The translation is in metres once the scale is known. The rotation needs no scale, and moves pixels
    // most.
    const ScaleEstimate scale = scaleOf(state_filter_.state(), {});
    const double alpha = scale.hasScale() ? scale.alpha : 0.0;
    const SE3 T_colour_depth(motion.rotation(), alpha * motion.translation());
    depth = compensateSkew(depth, camera_, T_colour_depth, moved_);
    if (depth.data != frame.depth.data) keepHoles(frame.depth, depth);
  }
  const cv::Size size = depth.size();
  const SortedDepth sorted =
      sortStrays(depth, options_.noise, {pool_.take<float>(size), pool_.take<float>(size)});
  sensor_.depth = withNoise(sorted, options_.noise, std::move(sensor_.depth), &sensor_.surface_variance);
  sensor_.of_any_range = sorted.confirmed;
  sensor_.credible = sorted.credible;
  sensor_.noise = options_.noise;
}

ScaleEstimate DepthFusion::updateState(Stamp keyframe, Stamp stamp) {
  const bool sampled = options_.scale.estimator == ScaleEstimatorKind::kWeightedRobust;
  const Overlap overlap = collectOverlap(points_, sensor_, camera_, sampled ? Overlap::kMaxSamples : 0);
  const ScaleEstimate fit = fitScale(overlap, options_.scale);
  std::optional<StateEvidence> evidence;
  if (!fit.refused) evidence = stateEvidence(overlap, fit, options_.scale);
  const SfmState state = state_filter_.update(evidence, keyframe, stamp, options_.scale);
  ScaleEstimate scale = scaleOf(state, fit);
  scale.refused = !evidence;
  return scale;
}

void DepthFusion::alignPoints() {
  // The published σ contains the common scale error, which is added after fusion: with that, and with
  // rounding, it keeps the limit. The common offset is not known before.
  const double common = static_cast<double>(options_.noise.common_scale_sigma),
               limit = options_.gaussian.max_relative_sigma;
  // The fit knows the spread of SfM's pixels over the spread that they state. A single frame's would flicker.
  const bool calibrates = options_.calibrate_sfm_variance && squared_spread_.isKnown();
  align(state_filter_.state(), camera_, std::sqrt(limit * limit - common * common) * (1.0 - 1e-6),
        calibrates ? squared_spread_.mean() : 1.0, &points_);
}

cv::Mat_<std::uint8_t> DepthFusion::markUnsupported(const GreyImage& grey,
                                                    const cv::Mat_<std::uint8_t>& measured) {
  cv::Mat_<std::uint8_t> marked = pool_.take<std::uint8_t>(measured.size());
  marked.setTo(0);
  markRims(measured, options_.rim_width, marked);
  const bool judged = options_.gaussian.min_inlier_probability > 0.0;
  if (judged && !grey.empty()) markShineThrough(grey, measured, pool_, marked);
  return marked;
}

void DepthFusion::reset() {
  state_filter_ = {};
  last_pose_ = {};
  previous_keyframe_.reset();
  squared_spread_ = {};
  other_surfaces_ = {};
  completion_ = {};
}

void DepthFusion::setOptions(const FusionOptions& options) {
  rgbd_sfm_fusion::validate(options);
  options_ = options;
  if (!options_.recent_keyframe) previous_keyframe_.reset();  // it would be an old one when it is used again
}

}  // namespace rgbd_sfm_fusion
