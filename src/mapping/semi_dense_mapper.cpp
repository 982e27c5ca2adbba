// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/semi_dense_mapper.h"

#include <utility>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kMinSupport = 2;  // neighbours of a published pixel that agree with it

}  // namespace

SemiDenseMapper::SemiDenseMapper(const PinholeCamera& camera) : camera_(camera), stereo_(camera) {
  const cv::Size size(camera.width, camera.height);
  map_.create(size);
  previous_map_.create(size);
  map_.clear();
}

void SemiDenseMapper::setImage(const cv::Mat_<float>& image, const MappingOptions& options) {
  std::swap(image_, previous_image_);
  image.copyTo(image_);
  gradient_.compute(image_);
  candidates_.collect(gradient_.x, gradient_.y, options.min_gradient);
}

void SemiDenseMapper::start(const cv::Mat_<float>& image, const MappingOptions& options) {
  setImage(image, options);
  map_.clear();
  regularise(map_, smoothed_, support_);
}

void SemiDenseMapper::moveTo(const cv::Mat_<float>& image, const SE3& T_new_old, const Brightness& brightness,
                             const MappingOptions& options) {
  setImage(image, options);
  std::swap(map_, previous_map_);
  propagate(camera_, previous_map_, previous_image_, T_new_old, brightness, image_, options, map_);
  regularise(map_, smoothed_, support_);
}

void SemiDenseMapper::observe(const StereoView& view, float max_inverse_depth,
                              const MappingOptions& options) {
  update(stereo_.observe(image_, candidates_, view, map_.estimate, smoothed_, max_inverse_depth, options),
         options, map_);
  regularise(map_, smoothed_, support_);
}

bool SemiDenseMapper::isReliable(int row, int column, const MappingOptions& options) const {
  const float rho = smoothed_.mean(row, column);
  const float max_sigma = options.max_relative_sigma * rho;
  return map_.observations(row, column) >= options.min_observations && support_(row, column) >= kMinSupport &&
         smoothed_.variance(row, column) <= max_sigma * max_sigma;
}

GaussianDepth SemiDenseMapper::depth(const MappingOptions& options) const {
  GaussianDepth result{DepthImage(camera_.height, camera_.width),
                       cv::Mat_<float>(camera_.height, camera_.width)};
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < camera_.height; ++v) {
    for (int u = 0; u < camera_.width; ++u) {
      const bool reliable = isReliable(v, u, options);
      const float depth = 1.0F / smoothed_.mean(v, u);
      result.mean(v, u) = reliable ? depth : kNone;
      result.variance(v, u) = reliable ? smoothed_.variance(v, u) * depth * depth * depth * depth : kNone;
    }
  }
  return result;
}

void SemiDenseMapper::reliable(const MappingOptions& options, InverseDepthImage& result) const {
  result.create(smoothed_.mean.size());
  for (int v = 0; v < camera_.height; ++v) {
    for (int u = 0; u < camera_.width; ++u) {
      const bool reliable = isReliable(v, u, options);
      result.mean(v, u) = reliable ? smoothed_.mean(v, u) : 0.0F;
      result.variance(v, u) = reliable ? smoothed_.variance(v, u) : std::numeric_limits<float>::infinity();
    }
  }
}

}  // namespace rgbd_sfm_fusion
