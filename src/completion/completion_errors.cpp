// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/completion_errors.h"

#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kOfMisfit = 3.3F;    // f
constexpr double kHarder = 4.0;      // mean square error over σ² in real holes, over that in hidden patches
constexpr float kMaxSquare = 25.0F;  // [σ²] larger squares are of another surface
constexpr double kPatience = 300.0;  // [cells] that make half of the largest step
constexpr float kLeastFactor = 0.1F;

}  // namespace

float CompletionErrors::prior(const CompletionEvidence& evidence) {
  return evidence.variance + kOfMisfit * evidence.misfit + evidence.other;
}

void CompletionErrors::observe(const CompletionEvidence& evidence, float error, float variance_of_truth) {
  const float expected = variance(evidence) / static_cast<float>(kHarder) + variance_of_truth;
  count_ += 1.0;
  squares_ += static_cast<double>(std::min(error * error / expected, kMaxSquare));
}

void CompletionErrors::learn() {
  if (count_ == 0.0) return;
  const double step = std::pow(squares_ / count_, 0.5 * count_ / (count_ + kPatience));
  factor_ = std::max(factor_ * static_cast<float>(step), kLeastFactor);
  count_ = squares_ = 0.0;
}

}  // namespace rgbd_sfm_fusion
