// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/tracking_depth.h"

#include <algorithm>
#include <limits>

#include "rgbd_sfm_fusion/image/image_squares.h"
#include "rgbd_sfm_fusion/mapping/regularisation.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// How well the depth of a random start is known.
constexpr double kRelativeSigma = 0.3;
constexpr auto kRelativeVariance = static_cast<float>(kRelativeSigma * kRelativeSigma);

// [px] The points in a square have errors that they share: the square is expected at a wrong distance, or,
// without a depth image, stereo's poses were wrong. If n of them counted each by itself, the error would seem
// to be smaller by the root of n. So it counts n times in each variance, with the largest n: on its finest
// levels, tracking uses every other point.
constexpr auto kSharingPoints = static_cast<float>(RowBands::kRows * RowBands::kRows / 2);

/// @param sharing  number of points that share an error of stereo's poses
RGBD_SFM_FUSION_MULTIVERSION
void fuseRows(const float* __restrict base_mean, const float* __restrict base_variance,
              const float* __restrict stereo_mean, const float* __restrict stereo_variances,
              const float* __restrict by_pose, float sharing, float* __restrict mean,
              float* __restrict variance, int count) {
  for (int u = 0; u < count; ++u) {
    const float stereo_variance = stereo_variances[u] + sharing * by_pose[u] * by_pose[u];
    const float w0 = 1.0F / base_variance[u], w1 = 1.0F / stereo_variance;
    const float difference = base_mean[u] - stereo_mean[u];
    const bool both = (w0 > 0.0F) & (w1 > 0.0F);
    const bool agree = difference * difference < kOneSurface * (base_variance[u] + stereo_variance);
    // Where stereo and base contradict each other, one of them is wrong, and tracking uses neither.
    const bool contradict = both & !agree;
    const float weight = contradict ? 0.0F : w0 + w1;
    mean[u] = weight > 0.0F ? (w0 * base_mean[u] + w1 * stereo_mean[u]) / weight : 0.0F;
    variance[u] = weight > 0.0F ? 1.0F / weight : kInfinity;
  }
}

/// Inverts depth. A pixel without depth keeps what was carried over.
RGBD_SFM_FUSION_MULTIVERSION
void invertOver(const float* __restrict depth, const float* __restrict depth_variance,
                const float* __restrict carried, const float* __restrict carried_variance, int count,
                float* __restrict mean, float* __restrict variance) {
  for (int i = 0; i < count; ++i) {
    const bool exists = depth[i] > 0.0F;
    const float inverse = 1.0F / depth[i], squared = inverse * inverse;
    mean[i] = exists ? inverse : carried[i];
    variance[i] = exists ? depth_variance[i] * squared * squared : carried_variance[i];
  }
}

void dropGaps(const float* depth, int count, float* mean, float* variance) {
  for (int i = 0; i < count; ++i) {
    if (depth[i] > 0.0F) continue;
    mean[i] = 0.0F;
    variance[i] = kInfinity;
  }
}

void forget(const cv::Rect& part, InverseDepthImage& image) {
  image.mean(part).setTo(0.0);
  image.variance(part).setTo(std::numeric_limits<double>::infinity());
}

}  // namespace

TrackingDepth::TrackingDepth(const PinholeCamera& camera) : camera_(camera), row_(camera.width) {
  warped_.resize(static_cast<std::size_t>(camera.width));
  for (InverseDepthImage* image : {&carried_, &with_sensor_, &fused_})
    image->create({camera.width, camera.height});
  is_expected_.create((camera.height + RowBands::kRows - 1) / RowBands::kRows,
                      (camera.width + RowBands::kRows - 1) / RowBands::kRows);
  variance_before_.create(camera.height, camera.width);
  clear();
}

void TrackingDepth::clear() {
  carried_.clear();
  has_sensor_ = false;
  had_sensor_ = false;
  expected_mean_ = expected_variance_ = 0.0;
  is_expected_.setTo(0);
}

void TrackingDepth::setSensor(const GaussianDepth& depth, Carried carried) {
  if (cv::countNonZero(depth.mean > 0.0F) == 0) return;
  const auto count = static_cast<int>(depth.mean.total());
  invertOver(depth.mean[0], depth.variance[0], carried_.mean[0], carried_.variance[0], count,
             with_sensor_.mean[0], with_sensor_.variance[0]);
  if (carried == Carried::kIsDropped)
    dropGaps(depth.mean[0], count, with_sensor_.mean[0], with_sensor_.variance[0]);
  forEachMarked(left_out_, depth.mean.size(), [&](const cv::Rect& square) { forget(square, with_sensor_); });
  has_sensor_ = true;
  had_sensor_ = true;
  learnExpected(depth.mean);
}

void TrackingDepth::setRandom(int size) {
  cv::RNG random(1);
  for (int v = 0; v < camera_.height; v += size) {
    for (int u = 0; u < camera_.width; u += size) {
      const cv::Rect patch(u, v, std::min(size, camera_.width - u), std::min(size, camera_.height - v));
      carried_.mean(patch).setTo(random.uniform(1.0 - kRelativeSigma, 1.0 + kRelativeSigma));
    }
  }
  carried_.variance.setTo(static_cast<double>(kRelativeVariance));
}

void TrackingDepth::moveTo(const InverseDepthWarp& warp) {
  dropExpected();
  carried_.clear();
  for (int v = 0; v < camera_.height; ++v) {
    row_.gather(fused_.mean[v]);
    warp.row(v, row_.columns.data(), row_.values.data(), row_.count, 0, warped_);
    for (std::size_t i = 0; i < row_.count; ++i) {
      const int pixel = warped_.pixel[i];
      if (pixel < 0) continue;
      const float inverse_depth = warped_.inverse_depth[i], derivative = warped_.derivative[i];
      const float noise = kCarriedRelativeSigma * inverse_depth;
      const float variance_before = fused_.variance(v, row_.columns[i]);
      const float variance = derivative * derivative * variance_before + noise * noise;
      const float mean_there = carried_.mean[0][pixel], variance_there = carried_.variance[0][pixel];
      if (mean_there > 0.0F) {
        // The nearer surface wins; of one surface without sensor depth, the better estimate. The nearer one
        // is that with the larger error, and without the sensor such errors add up from keyframe to keyframe.
        // Variances are those before the move, since the move makes near ones small.
        const float difference = inverse_depth - mean_there;
        const bool same_surface =
            !has_sensor_ && difference * difference < kOneSurface * (variance + variance_there);
        if (same_surface ? variance_before >= variance_before_[0][pixel] : difference < 0.0F) continue;
      }
      carried_.mean[0][pixel] = inverse_depth;
      carried_.variance[0][pixel] = variance;
      variance_before_[0][pixel] = variance_before;
    }
  }
  has_sensor_ = false;
  learnExpected(DepthImage());
}

/// What the sensor does not see is expected to be where carried depth of it is: that comes from stereo, or
/// from the sensor in other views. A priori it is anywhere between infinity and the mean of what is known,
/// and that counts as much as the points of a square.
/// @param sensor  empty without a depth image
void TrackingDepth::learnExpected(const DepthImage& sensor) {
  const double known = base().meanInverseDepth();
  if (!(known > 0.0)) return;  // the camera has turned away from all: as it was
  const auto prior = static_cast<double>(kSharingPoints);
  double count = prior, sum = prior * known / 2.0, squares = prior * known * known / 3.0;
  for (std::size_t i = 0; i < carried_.mean.total(); ++i) {
    const auto carried = static_cast<double>(carried_.mean[0][i]);
    if (!(carried > 0.0) || (!sensor.empty() && sensor[0][i] > 0.0F)) continue;
    sum += carried, squares += carried * carried, count += 1.0;
  }
  expected_mean_ = sum / count;
  expected_variance_ = squares / count - expected_mean_ * expected_mean_;
}

void TrackingDepth::contestByCarried(double parallax) {
  if (has_sensor_) dropContested(carried_, parallax, RowBands::all());
}

const InverseDepthImage& TrackingDepth::fuse(const Stereo& stereo, double parallax, const RowBands& bands) {
  if (has_sensor_) dropContested(stereo.depth, parallax, bands);
  // Without any sensor depth so far, all that there is shares its errors, and nothing has to be weighed.
  const float with_image = had_sensor_ ? stereo.sharing_points : 0.0F;
  const float sharing = restsOnCarried() ? kSharingPoints : with_image;
  bands.forEach(camera_.height, [&](int first, int end) {
    is_expected_.row(first / RowBands::kRows).setTo(0);
    fuseRows(base().mean[first], base().variance[first], stereo.depth.mean[first],
             stereo.depth.variance[first], stereo.by_pose[first], sharing, fused_.mean[first],
             fused_.variance[first], (end - first) * camera_.width);
  });
  dropLeftOut(bands);
  return fused_;
}

const InverseDepthImage& TrackingDepth::expectRest(const RowBands& bands) {
  if (!had_sensor_) return fused_;  // nothing tells the scale
  bands.forEach(camera_.height, [&](int first, int /*end*/) {
    for (int u = 0; u < camera_.width; u += RowBands::kRows) {
      const cv::Rect square = squareAt(u, first);
      if (cv::countNonZero(fused_.mean(square)) > 0) continue;
      fused_.mean(square).setTo(expected_mean_);
      fused_.variance(square).setTo(static_cast<double>(kSharingPoints) * expected_variance_);
      is_expected_(first / RowBands::kRows, u / RowBands::kRows) = 1;
    }
  });
  dropLeftOut(bands);
  return fused_;
}

void TrackingDepth::dropLeftOut(const RowBands& bands) {
  static_assert(RowBands::kRows % kSquare == 0, "a square is in one band");
  forEachMarked(left_out_, {camera_.width, camera_.height}, [&](const cv::Rect& square) {
    if (!bands.has(square.y / RowBands::kRows)) return;
    forget(square, fused_);
  });
}

void TrackingDepth::dropExpected() {
  for (int row = 0; row < is_expected_.rows; ++row) {
    for (int column = 0; column < is_expected_.cols; ++column) {
      if (is_expected_(row, column) == 0) continue;
      const cv::Rect square = squareAt(column * RowBands::kRows, row * RowBands::kRows);
      forget(square, fused_);
      is_expected_(row, column) = 0;
    }
  }
}

/// A square as high as a band of rows, as far as it is in the image.
cv::Rect TrackingDepth::squareAt(int u, int v) const {
  return {u, v, std::min(RowBands::kRows, camera_.width - u), std::min(RowBands::kRows, camera_.height - v)};
}

float TrackingDepth::independentShare() const {
  return has_sensor_ ? 0.0F : Regulariser::kAlike / static_cast<float>(Regulariser::kAveraged);
}

void TrackingDepth::dropContested(const InverseDepthImage& other, double parallax, const RowBands& bands) {
  for (const cv::Rect& cell : contested_.find(with_sensor_, other, parallax, bands)) {
    forget(cell, with_sensor_);
  }
}

}  // namespace rgbd_sfm_fusion
