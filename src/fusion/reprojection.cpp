// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reprojection.h"

#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/geometry/depth_warp.h"
#include "rgbd_sfm_fusion/geometry/gap_closer.h"
#include "rgbd_sfm_fusion/geometry/occupied_columns.h"
#include "rgbd_sfm_fusion/geometry/splatting.h"
#include "rgbd_sfm_fusion/mapping/epipolar_segments.h"
#include "rgbd_sfm_fusion/mapping/mapping_options.h"
#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

namespace rgbd_sfm_fusion {
namespace {

/// The image with nothing between its rows, so that a single index finds each pixel.
cv::Mat_<float> continuous(const cv::Mat_<float>& image) {
  return image.isContinuous() ? image : cv::Mat_<float>(image.clone());
}

/// Variance of Z' by the pose: J Σ Jᵀ with J = ∂Z'/∂(x y z rx ry rz) = (0, 0, 1, Y', -X', 0).
struct PoseTerms {
  float zz, z_rx, z_ry, rx_rx, rx_ry, ry_ry;
};

RGBD_SFM_FUSION_MULTIVERSION
void addPoseVarianceRow(const float* mean, int begin, int end, float x_per_z_first, float x_per_z_step,
                        float y_per_z, const PoseTerms pose, float* variance) {
  for (int i = begin; i < end; ++i) {
    const float z = mean[i];
    const float x_per_z = x_per_z_first + x_per_z_step * static_cast<float>(i);
    const float linear = 2.0f * (y_per_z * pose.z_rx - x_per_z * pose.z_ry);
    const float quadratic = y_per_z * y_per_z * pose.rx_rx - 2.0f * x_per_z * y_per_z * pose.rx_ry +
                            x_per_z * x_per_z * pose.ry_ry;
    const float by_pose = pose.zz + z * (linear + z * quadratic);
    const float v = variance[i] + (by_pose > 0.0f ? by_pose : 0.0f);  // rounding can make it negative
    variance[i] = z > 0.0f ? v : kNoDepth;
  }
}

PoseTerms poseTerms(const Matrix6& covariance) {
  const auto entry = [&](int i, int j) { return static_cast<float>(covariance(i, j)); };
  return {entry(2, 2), entry(2, 3), entry(2, 4), entry(3, 3), entry(3, 4), entry(4, 4)};
}

/// Adds the parts of the variance that depend on where in the frame a point is seen.
class SeenVariance {
 public:
  SeenVariance(const PinholeCamera& camera, const Matrix6& pose_covariance,
               const ReprojectionOptions& options)
      : camera_(camera),
        pose_(options.pose_covariance ? poseTerms(pose_covariance) : PoseTerms{}),
        lateral_(options.splat == Splat::kNearest ? options.lateral_sigma : 0.0f, camera.width) {}

  /// @param parts  of the row: it has depth nowhere else
  /// @param depth  has final means in row `y` and in the rows beside it
  void addToRow(int y, const std::vector<cv::Range>& parts, GaussianDepth* depth) {
    float* variance = depth->variance[y];
    for (const cv::Range& part : parts) {
      addPoseVarianceRow(depth->mean[y], part.start, part.end, static_cast<float>(-camera_.cx / camera_.fx),
                         static_cast<float>(1.0 / camera_.fx),
                         static_cast<float>((y - camera_.cy) / camera_.fy), pose_, variance);
      lateral_.addToRow(depth->mean, y, part, variance);
    }
  }

 private:
  const PinholeCamera& camera_;
  PoseTerms pose_;
  LateralVariance lateral_;
};

/// Three rows of the keyframe's own depth. At the image's border, `up` or `down` is the middle row.
struct OwnRows {
  const float *up, *middle, *down, *variance;
};

/// A carried depth is used where the keyframe has no depth, and where no neighbour in the keyframe would hide
/// it.
RGBD_SFM_FUSION_MULTIVERSION
void fillRow(const OwnRows own, const float* carried_mean, const float* carried_variance, int width,
             float* __restrict mean, float* __restrict variance) {
  for (const int x : {0, width - 1}) mean[x] = own.middle[x], variance[x] = own.variance[x];
  for (int x = 1; x < width - 1; ++x) {
    const float z = own.middle[x], carried = carried_mean[x];
    const float front = (1.0f - kStepRatio) * carried;
    const bool hidden = (own.middle[x - 1] < front) | (own.middle[x + 1] < front) | (own.up[x] < front) |
                        (own.down[x] < front);
    const bool empty = !(z > 0.0f);
    mean[x] = empty ? (hidden ? kNoDepth : carried) : z;
    variance[x] = empty ? (hidden ? kNoDepth : carried_variance[x]) : own.variance[x];
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void markPlainRow(const std::uint8_t* brightest, const std::uint8_t* darkest, const std::uint8_t* measured,
                  int width, std::uint8_t least_contrast, std::uint8_t* __restrict marked) {
  for (int x = 0; x < width; ++x) {
    const auto contrast = static_cast<std::uint8_t>(brightest[x] - darkest[x]);
    const auto plain = static_cast<std::uint8_t>(contrast < least_contrast ? 1 : 0);
    marked[x] = marked[x] | (plain & (measured[x] ^ std::uint8_t{1}));
  }
}

}  // namespace

GaussianDepth reproject(const GaussianDepth& keyframe_depth, const PinholeCamera& camera,
                        const SE3& T_frame_keyframe, const Matrix6& pose_covariance,
                        const ReprojectionOptions& options, GaussianDepth buffer) {
  if (isIdentity(T_frame_keyframe)) return keyframe_depth;
  // Images of messages may have something between their rows.
  const GaussianDepth keyframe{continuous(keyframe_depth.mean), continuous(keyframe_depth.variance)};
  const float sigmas_squared = options.same_surface * options.same_surface;
  const DepthWarp to_frame(camera, T_frame_keyframe), to_keyframe(camera, T_frame_keyframe.inverse());
  GaussianDepth frame;
  if (buffer.mean.isContinuous() && buffer.variance.isContinuous()) frame = std::move(buffer);
  frame.mean.create(camera.height, camera.width);
  frame.variance.create(camera.height, camera.width);
  if (options.splat == Splat::kBilinear) {
    splatBilinear(keyframe, to_frame, sigmas_squared, &frame);
  } else {
    splatNearest(keyframe, to_frame, sigmas_squared, &frame);
  }
  GapCloser gaps(keyframe, to_frame, to_keyframe, sigmas_squared);
  SeenVariance variance(camera, pose_covariance, options);
  OccupiedColumns occupied(frame.mean);
  std::vector<cv::Range> parts, of_last, of_second_last;  // of the rows y, y - 1 and y - 2
  // advance(y) closes the gaps of row y - 1. Then row y - 2 and the rows beside it have their final means,
  // and are still in the cache.
  for (int y = 0; y < camera.height + 2; ++y) {
    std::swap(of_second_last, of_last);
    std::swap(of_last, parts);
    if (y < camera.height) parts = occupied.near(y);
    if (options.close_gaps && y < camera.height) gaps.advance(y, parts, &frame);
    if (y >= 2) variance.addToRow(y - 2, of_second_last, &frame);
  }
  return frame;
}

void markShineThrough(const GreyImage& grey, const cv::Mat_<std::uint8_t>& measured, ImagePool& pool,
                      cv::Mat_<std::uint8_t>& marked) {
  // Where stereo begins, brightness changes by this much over the radius of its pattern. So far beside its
  // point, an edge may land: the image is searched there.
  const auto least_contrast = static_cast<std::uint8_t>(kPatternRadius * MappingOptions().min_gradient);
  const cv::Mat square = cv::Mat::ones(2 * kPatternRadius + 1, 2 * kPatternRadius + 1, CV_8U);
  GreyImage brightest = pool.take<std::uint8_t>(grey.size()), darkest = pool.take<std::uint8_t>(grey.size());
  cv::dilate(grey, brightest, square);
  cv::erode(grey, darkest, square);
  for (int y = 0; y < marked.rows; ++y)
    markPlainRow(brightest[y], darkest[y], measured[y], marked.cols, least_contrast, marked[y]);
}

GaussianDepth PreviousKeyframe::fillGaps(const TrackingResult& tracked,
                                         const std::shared_ptr<const KeyframeMap>& keyframe,
                                         const ReprojectionOptions& options, ImagePool& pool) {
  const SE3 T_first_keyframe = tracked.T_first_frame * tracked.T_frame_keyframe;
  if (current_ && current_->stamp != keyframe->stamp) {
    carried_ = reproject(current_->depth, current_->camera, T_first_keyframe.inverse() * T_first_current_,
                         covariance_, options);
  }
  current_ = keyframe;
  T_first_current_ = T_first_keyframe;
  covariance_ = tracked.covariance;

  const GaussianDepth& own = keyframe->depth;
  if (carried_.mean.empty()) return own;
  GaussianDepth filled{pool.take<float>(own.mean.size()), pool.take<float>(own.mean.size())};
  const int last = own.mean.rows - 1;
  for (int y = 0; y <= last; ++y) {
    const OwnRows rows{own.mean[y > 0 ? y - 1 : y], own.mean[y], own.mean[y < last ? y + 1 : y],
                       own.variance[y]};
    fillRow(rows, carried_.mean[y], carried_.variance[y], own.mean.cols, filled.mean[y], filled.variance[y]);
  }
  return filled;
}

void PreviousKeyframe::reset() {
  *this = PreviousKeyframe();
}

}  // namespace rgbd_sfm_fusion
