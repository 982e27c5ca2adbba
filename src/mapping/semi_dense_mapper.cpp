// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/semi_dense_mapper.h"

#include <utility>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kMinSupport = 2;  // neighbours of a published pixel that agree with it

RGBD_SFM_FUSION_MULTIVERSION
void selectReliable(const float* __restrict smoothed, const float* __restrict variance,
                    const std::uint8_t* __restrict observations, const std::uint8_t* __restrict support,
                    int count, int min_observations, float max_relative_variance, float* __restrict reliable,
                    float* __restrict reliable_variance) {
  for (int i = 0; i < count; ++i) {
    const bool is_reliable = (static_cast<int>(observations[i]) >= min_observations) &
                             (static_cast<int>(support[i]) >= kMinSupport) &
                             (variance[i] <= max_relative_variance * smoothed[i] * smoothed[i]);
    reliable[i] = is_reliable ? smoothed[i] : 0.0F;
    reliable_variance[i] = is_reliable ? variance[i] : std::numeric_limits<float>::infinity();
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void multiplyByScatter(const float* __restrict scatter, const std::uint8_t* __restrict support, int count,
                       float* __restrict variance) {
  constexpr float kLeast = 0.03F, kLargest = 16.0F;  // of the scatter
  constexpr float kTypicalSupport = 9.0F;  // pixels, which leave the variance as it is; fusion calibrates it
  for (int i = 0; i < count; ++i) {
    const float averaged = kTypicalSupport / (1.0F + static_cast<float>(support[i]));
    variance[i] *= lesser(greater(scatter[i], kLeast), kLargest) * averaged;
  }
}

/// Adds the error of each depth, which is the error of its inverse times the depth squared.
RGBD_SFM_FUSION_MULTIVERSION
void addReadoutVariance(const float* __restrict by_readout, const float* __restrict depth, int count,
                        float sigma, float* __restrict variance) {
  for (int i = 0; i < count; ++i) {
    const float error = sigma * by_readout[i] * depth[i] * depth[i];
    variance[i] += error * error;
  }
}

}  // namespace

SemiDenseMapper::SemiDenseMapper(const PinholeCamera& camera) : camera_(camera), stereo_(camera) {
  const cv::Size size(camera.width, camera.height);
  map_.create(size);
  previous_map_.create(size);
  map_.clear();
}

void SemiDenseMapper::setImage(const ImagePyramid& keyframe, const MappingOptions& options) {
  std::swap(image_, previous_image_);
  keyframe[0].copyTo(image_);
  gradient_.compute(image_);
  candidates_.collect(gradient_, keyframe.seen(0), options.min_gradient);
  regulariser_.setCandidates(candidates_, image_.size());
}

void SemiDenseMapper::start(const ImagePyramid& keyframe, const MappingOptions& options) {
  setImage(keyframe, options);
  map_.clear();
}

void SemiDenseMapper::moveTo(const ImagePyramid& keyframe, const InverseDepthWarp& warp,
                             const Brightness& brightness, const MappingOptions& options) {
  setImage(keyframe, options);
  std::swap(map_, previous_map_);
  propagate({previous_image_, image_, keyframe.seen(0), warp, brightness}, previous_map_, candidates_,
            options, map_);
  new_candidates_.collectWithout(candidates_, map_.observations);
  regulariser_.apply(map_);
}

void SemiDenseMapper::observe(const StereoView& view, float max_inverse_depth,
                              const MappingOptions& options) {
  observe(candidates_, view, max_inverse_depth, options);
}

void SemiDenseMapper::observeNew(const StereoView& view, float max_inverse_depth,
                                 const MappingOptions& options) {
  observe(new_candidates_, view, max_inverse_depth, options);
}

void SemiDenseMapper::observe(const StereoCandidates& candidates, const StereoView& view,
                              float max_inverse_depth, const MappingOptions& options) {
  const KnownDepths known{map_.estimate, map_.observations, regulariser_.smoothed(), max_inverse_depth};
  update(stereo_.observe(image_, candidates, view, known, options), map_);
  regulariser_.apply(map_);
}

void SemiDenseMapper::reliable(const MappingOptions& options, InverseDepthImage& result) const {
  const InverseDepthImage& smoothed = regulariser_.smoothed();
  result.create(smoothed.mean.size());
  selectReliable(smoothed.mean[0], smoothed.variance[0], map_.observations[0], regulariser_.support()[0],
                 static_cast<int>(smoothed.mean.total()), options.min_observations,
                 options.max_relative_sigma * options.max_relative_sigma, result.mean[0], result.variance[0]);
}

const InverseDepthImage& SemiDenseMapper::published(const InverseDepthImage& reliable,
                                                    const MappingOptions& options) {
  if (!options.smooth_published) return reliable;
  regulariser_.smoothWidely(reliable, published_);
  return published_;
}

void SemiDenseMapper::followScatter(cv::Mat_<float>& variance) const {
  multiplyByScatter(regulariser_.scatter()[0], regulariser_.support()[0], static_cast<int>(variance.total()),
                    variance[0]);
}

void SemiDenseMapper::addReadoutVariance(double sigma, GaussianDepth& depth) const {
  rgbd_sfm_fusion::addReadoutVariance(map_.by_readout[0], depth.mean[0], static_cast<int>(depth.mean.total()),
                                      static_cast<float>(sigma), depth.variance[0]);
}

}  // namespace rgbd_sfm_fusion
