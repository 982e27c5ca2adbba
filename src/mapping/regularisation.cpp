// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/regularisation.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kRadius = Regulariser::kRadius;
constexpr float kAgreement = 4.0F;  // [σ²] by which neighbours of one surface may differ
// The wider mean, which is published, has the same neighbours, farther apart: each was averaged as far as the
// next one.
constexpr int kWideSpacing = kRadius;
constexpr int kWideReach = kWideSpacing * kRadius;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Regularises kLanes pixels from `begin` on, in an image with rows of length `stride`.
RGBD_SFM_FUSION_MULTIVERSION
void regulariseBlock(const float* __restrict means, const float* __restrict variances,
                     const float* __restrict weights, const float* __restrict scatters, int begin, int stride,
                     float* __restrict smoothed_means, float* __restrict smoothed_variances,
                     float* __restrict smoothed_scatters, std::uint8_t* __restrict support) {
  float weight[kLanes] = {}, weighted[kLanes] = {}, squares[kLanes] = {}, count[kLanes] = {};
  float scatter[kLanes] = {};
  float mean[kLanes], variance[kLanes];
  for (int l = 0; l < kLanes; ++l) mean[l] = means[begin + l], variance[l] = variances[begin + l];
  for (int dv = -kRadius; dv <= kRadius; ++dv) {
    // Every other neighbour, like the black squares of a chess board, has the same reach for half the work.
    for (int du = -kRadius + (dv & 1); du <= kRadius; du += 2) {
      const int other = begin + dv * stride + du;
      for (int l = 0; l < kLanes; ++l) {
        const float other_mean = means[other + l], other_variance = variances[other + l];
        const float difference = mean[l] - other_mean;
        const float exists = other_mean > 0.0F ? 1.0F : 0.0F;
        // A gap's variance is infinite: all neighbours agree with it.
        const float agrees =
            difference * difference < kAgreement * (variance[l] + other_variance) ? exists : 0.0F;
        const float w = agrees * weights[other + l], w_mean = w * other_mean;
        weight[l] += w;
        weighted[l] += w_mean;
        squares[l] += w_mean * other_mean;
        count[l] += agrees;
        scatter[l] += agrees * scatters[other + l];
      }
    }
  }
  for (int l = 0; l < kLanes; ++l) {
    const bool has_estimate = mean[l] > 0.0F;
    const bool is_gap = !has_estimate & (count[l] > static_cast<float>(Regulariser::kMinSupport));
    const float smoothed = weighted[l] / weight[l];
    const float spread = std::max(squares[l] / weight[l] - smoothed * smoothed, 0.0F);
    const float gap_variance = spread + count[l] / weight[l] + 0.01F * smoothed * smoothed;
    smoothed_means[begin + l] = has_estimate | is_gap ? smoothed : 0.0F;
    smoothed_variances[begin + l] = has_estimate ? variance[l] : (is_gap ? gap_variance : kInfinity);
    smoothed_scatters[begin + l] = scatter[l] / count[l];
    support[begin + l] = static_cast<std::uint8_t>(has_estimate ? static_cast<int>(count[l]) - 1 : 0);
  }
}

/// Averages the estimates of kLanes pixels from `begin` on over neighbours that are kWideSpacing apart.
RGBD_SFM_FUSION_MULTIVERSION
void smoothWidelyBlock(const float* __restrict means, const float* __restrict variances,
                       const float* __restrict weights, int begin, int stride, float* __restrict smoothed,
                       float* __restrict smoothed_variances) {
  float weight[kLanes] = {}, weighted[kLanes] = {};
  float mean[kLanes], variance[kLanes];
  for (int l = 0; l < kLanes; ++l) mean[l] = means[begin + l], variance[l] = variances[begin + l];
  for (int dv = -kRadius; dv <= kRadius; ++dv) {
    for (int du = -kRadius + (dv & 1); du <= kRadius; du += 2) {
      const int other = begin + kWideSpacing * (dv * stride + du);
      for (int l = 0; l < kLanes; ++l) {
        const float other_mean = means[other + l], difference = mean[l] - other_mean;
        const bool agrees = difference * difference < kAgreement * (variance[l] + variances[other + l]);
        const float w = agrees ? weights[other + l] : 0.0F;  // 0 without an estimate
        weight[l] += w;
        weighted[l] += w * other_mean;
      }
    }
  }
  for (int l = 0; l < kLanes; ++l) {
    smoothed[begin + l] = mean[l] > 0.0F ? weighted[l] / weight[l] : 0.0F;
    smoothed_variances[begin + l] = mean[l] > 0.0F ? Regulariser::kAlike / weight[l] : kInfinity;
  }
}

RGBD_SFM_FUSION_MULTIVERSION
void invert(const float* __restrict values, float* __restrict inverses, int count) {
  for (int i = 0; i < count; ++i) inverses[i] = 1.0F / values[i];
}

}  // namespace

void Regulariser::setCandidates(const StereoCandidates& candidates, const cv::Size& size) {
  blocks_.resize(candidates.bands().size());
  int last = -1;
  for (std::size_t band = 0; band < blocks_.size(); ++band) {
    blocks_[band].clear();
    for (const StereoCandidates::Block& block : candidates.bands()[band]) {
      for (const int pixel : block.pixel) {
        if (pixel / kLanes == last) continue;
        last = pixel / kLanes;
        blocks_[band].push_back(last * kLanes);
      }
    }
  }
  smoothed_.create(size);
  smoothed_.clear();
  support_.create(size);
  support_.setTo(0);
  weights_.create(size);
  scatter_.create(size);
  scatter_.setTo(1.0);
}

void Regulariser::apply(const SemiDenseMap& map, const RowBands& bands) {
  const cv::Mat_<float>&mean = map.estimate.mean, &variance = map.estimate.variance;
  bands.forEach(mean.rows, [&](int first, int end) {
    weigh(variance, first - kRadius - 1, end + kRadius + 1);
    // A row is treated as if it went on in the next row. The borders have no candidates (StereoCandidates).
    // An estimate that was carried there may meet the other end of a row, which then has to agree with it,
    // too.
    for (const int begin : blocks_[static_cast<std::size_t>(first / RowBands::kRows)]) {
      regulariseBlock(mean[0], variance[0], weights_[0], map.scatter[0], begin, mean.cols, smoothed_.mean[0],
                      smoothed_.variance[0], scatter_[0], support_[0]);
    }
  });
}

void Regulariser::setPriors(const std::vector<StereoObservation>& observations, const SemiDenseMap& map) {
  for (const StereoObservation& observed : observations) {
    const int i = observed.pixel;
    if (map.observations[0][i] != 1 || support_[0][i] > 0) continue;
    smoothed_.mean[0][i] = map.estimate.mean[0][i];
    smoothed_.variance[0][i] = map.estimate.variance[0][i];
  }
}

bool Regulariser::isContradicted(const SemiDenseMap& map, int pixel) const {
  const float mean = map.estimate.mean[0][pixel], variance = map.estimate.variance[0][pixel];
  int neighbours = 0, agreeing = 0, supported = 0;  // the pixel is one of the neighbours, and agrees
  for (int dv = -kRadius; dv <= kRadius; ++dv) {
    for (int du = -kRadius + (dv & 1); du <= kRadius; du += 2) {
      ++neighbours;
      const int other = pixel + dv * map.estimate.mean.cols + du;
      const float other_mean = map.estimate.mean[0][other], difference = mean - other_mean;
      if (other_mean <= 0.0F) continue;
      const bool agrees = difference * difference < kAgreement * (variance + map.estimate.variance[0][other]);
      agreeing += agrees ? 1 : 0;
      supported += !agrees && support_[0][other] >= kMinSupport ? 1 : 0;
    }
  }
  return agreeing <= kMinSupport && 2 * supported >= neighbours - 1;
}

void Regulariser::smoothWidely(const InverseDepthImage& from, InverseDepthImage& result,
                               const RowBands& bands) {
  result.create(from.mean.size());
  bands.forEach(from.mean.rows, [&](int first, int end) {
    weigh(from.variance, first - kWideReach - 1, end + kWideReach + 1);
    const int pixels = (end - first) * from.mean.cols;
    std::fill_n(result.mean[first], pixels, 0.0F);
    std::fill_n(result.variance[first], pixels, kInfinity);
    for (const int begin : blocks_[static_cast<std::size_t>(first / RowBands::kRows)]) {
      const float* const mean = from.mean[0] + begin;
      if (std::all_of(mean, mean + kLanes, [](float value) { return value == 0.0F; })) continue;
      smoothWidelyBlock(from.mean[0], from.variance[0], weights_[0], begin, from.mean.cols, result.mean[0],
                        result.variance[0]);
    }
  });
}

/// Sets the weights of a range of rows, as far as it is in the image. A pixel at the end of a row meets the
/// end of the row before, so that a neighbourhood has one more row to either side.
void Regulariser::weigh(const cv::Mat_<float>& variance, int first, int end) {
  first = std::max(first, 0), end = std::min(end, variance.rows);
  invert(variance[first], weights_[first], (end - first) * variance.cols);
}

}  // namespace rgbd_sfm_fusion
