// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/semi_dense_mapper.h"

#include <limits>
#include <utility>

#include "rgbd_sfm_fusion/image/image_squares.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

RGBD_SFM_FUSION_MULTIVERSION
void selectReliable(const float* __restrict smoothed, const float* __restrict variance,
                    const std::uint8_t* __restrict observations, const std::uint8_t* __restrict support,
                    int count, int min_observations, float max_relative_variance, float* __restrict reliable,
                    float* __restrict reliable_variance) {
  for (int i = 0; i < count; ++i) {
    const bool is_reliable = (static_cast<int>(observations[i]) >= min_observations) &
                             (static_cast<int>(support[i]) >= Regulariser::kMinSupport) &
                             (variance[i] <= max_relative_variance * smoothed[i] * smoothed[i]);
    reliable[i] = is_reliable ? smoothed[i] : 0.0F;
    reliable_variance[i] = is_reliable ? variance[i] : std::numeric_limits<float>::infinity();
  }
}

/// How far variances follow what the error model leaves out.
struct DepthTerms {
  bool follow_scatter;
  float readout_sigma;  // [s]
};

RGBD_SFM_FUSION_MULTIVERSION
void invert(const float* __restrict mean, const float* __restrict inverse_variance,
            const float* __restrict scatter, const float* __restrict by_readout, int count,
            const DepthTerms terms, float* __restrict depth, float* __restrict variance) {
  for (int i = 0; i < count; ++i) {
    const bool exists = mean[i] > 0.0F;
    const float z = 1.0F / mean[i], squared = z * z;
    const float factor = terms.follow_scatter ? scatter[i] : 1.0F;
    // The error of a depth is the error of its inverse times the depth squared.
    const float error = terms.readout_sigma * by_readout[i] * z * z;
    depth[i] = exists ? z : kNoDepth;
    variance[i] = exists ? inverse_variance[i] * squared * squared * factor + error * error : kNoDepth;
  }
}

}  // namespace

SemiDenseMapper::SemiDenseMapper(const PinholeCamera& camera)
    : search_(camera), propagation_({camera.width, camera.height}) {
  const cv::Size size(camera.width, camera.height);
  map_.create(size);
  previous_map_.create(size);
}

void SemiDenseMapper::setImage(const ImagePyramid& keyframe, const MappingOptions& options) {
  previous_image_ = image_;
  image_ = keyframe.grey();
  candidates_.collect(keyframe[0], keyframe.seen(0), options.min_gradient);
  if (!left_out_.empty()) {
    new_.collectFrom(candidates_, RowBands::all(), [&](int pixel) {
      return left_out_(pixel / image_.cols / kSquare, pixel % image_.cols / kSquare) == 0;
    });
    std::swap(candidates_, new_);
  }
  regulariser_.setCandidates(candidates_, image_.size());
}

void SemiDenseMapper::start(const ImagePyramid& keyframe, const MappingOptions& options) {
  setImage(keyframe, options);
  map_.clear();
  collectOpen(RowBands::all(), options);
}

void SemiDenseMapper::moveTo(const ImagePyramid& keyframe, const InverseDepthWarp& warp,
                             const Brightness& brightness, const MappingOptions& options) {
  setImage(keyframe, options);
  std::swap(map_, previous_map_);
  propagation_.run({previous_image_, keyframe[0], keyframe.seen(0), warp, brightness}, previous_map_,
                   candidates_, options, map_);
  forgetLeftOut();
  regulariser_.apply(map_);
  collectOpen(RowBands::all(), options);
}

void SemiDenseMapper::observe(const StereoView& view, float max_inverse_depth, const RowBands& bands,
                              const MappingOptions& options) {
  observe(CandidatesByBand{candidates_, open_, bands}, view, max_inverse_depth, options);
  collectOpen(bands, options);
}

void SemiDenseMapper::observeNew(const std::vector<StereoView>& views, float max_inverse_depth,
                                 const MappingOptions& options) {
  new_.collectFrom(candidates_, RowBands::all(), [&](int pixel) { return map_.observations[0][pixel] == 0; });
  for (const StereoView& view : views)
    observe(CandidatesByBand{new_, new_, RowBands::all()}, view, max_inverse_depth, options);
  collectOpen(RowBands::all(), options);
}

void SemiDenseMapper::observe(const CandidatesByBand& candidates, const StereoView& view,
                              float max_inverse_depth, const MappingOptions& options) {
  const KnownDepths known{map_.estimate, map_.observations, regulariser_.smoothed(), max_inverse_depth};
  const std::vector<StereoObservation>& observations =
      search_.observe(image_, candidates, view, known, options);
  update(observations, map_);
  forgetContradicted(observations, options);
  forgetLeftOut();
  regulariser_.setPriors(observations, map_);
  regulariser_.apply(map_, candidates.bands);
}

/// A wrong match is looked for, and found again, where it was found before. Without an estimate, the pixel is
/// searched for where its neighbours are.
void SemiDenseMapper::forgetContradicted(const std::vector<StereoObservation>& observations,
                                         const MappingOptions& options) {
  for (const StereoObservation& observed : observations) {
    const int i = observed.pixel;
    if (map_.observations[0][i] < options.min_observations ||
        regulariser_.support()[0][i] >= Regulariser::kMinSupport)
      continue;
    if (regulariser_.isContradicted(map_, i)) map_.clearPixel(i);
  }
}

/// Collects the pixels whose own estimate is not good enough yet. A pixel that was rejected has to wait for
/// its turn: the next view shows it almost as the last one did.
void SemiDenseMapper::collectOpen(const RowBands& bands, const MappingOptions& options) {
  const float max_relative_variance = options.max_relative_sigma * options.max_relative_sigma;
  open_.collectFrom(candidates_, bands, [&](int pixel) {
    const float mean = map_.estimate.mean[0][pixel], variance = map_.estimate.variance[0][pixel];
    const bool is_good = (map_.observations[0][pixel] >= options.min_observations) &
                         (variance <= max_relative_variance * mean * mean);
    return !is_good & (map_.rejections[0][pixel] == 0);
  });
}

void SemiDenseMapper::forgetLeftOut() {
  forEachMarked(left_out_, image_.size(), [&](const cv::Rect& square) {
    for (int v = square.y; v < square.br().y; ++v) {
      for (int u = square.x; u < square.br().x; ++u) map_.clearPixel(v * image_.cols + u);
    }
  });
}

void SemiDenseMapper::reliable(const RowBands& bands, const MappingOptions& options,
                               InverseDepthImage& result) const {
  const InverseDepthImage& smoothed = regulariser_.smoothed();
  result.create(smoothed.mean.size());
  bands.forEach(result.mean.rows, [&](int first, int end) {
    selectReliable(smoothed.mean[first], smoothed.variance[first], map_.observations[first],
                   regulariser_.support()[first], (end - first) * result.mean.cols, options.min_observations,
                   options.max_relative_sigma * options.max_relative_sigma, result.mean[first],
                   result.variance[first]);
  });
}

void SemiDenseMapper::toDepth(const InverseDepthImage& reliable, const RowBands& bands, float readout_sigma,
                              const MappingOptions& options, GaussianDepth& depth) {
  if (options.smooth_published) regulariser_.smoothWidely(reliable, averaged_, bands);
  const InverseDepthImage& from = options.smooth_published ? averaged_ : reliable;
  bands.forEach(depth.mean.rows, [&](int first, int end) {
    invert(from.mean[first], from.variance[first], regulariser_.scatter()[first], map_.by_readout[first],
           (end - first) * depth.mean.cols, {options.follow_scatter, readout_sigma}, depth.mean[first],
           depth.variance[first]);
  });
}

}  // namespace rgbd_sfm_fusion
