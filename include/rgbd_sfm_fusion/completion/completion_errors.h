// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace rgbd_sfm_fusion {

/// What decides the variance of a completed depth. All are relative to the square of inverse depth.
struct CompletionEvidence {
  float misfit = 0.0F;    ///< [1] mean square deviation from the plane: see Surfaces
  float variance = 0.0F;  ///< [1] variance that the supports have in common: see Surfaces
  float other = 0.0F;     ///< [1] second moment, as the cell may be of another surface: see Surfaces
};

/// The variance of completed depth, relative to the square of depth or inverse depth. At first, it is
///
///     prior = variance + f misfit + other
///
/// How far surfaces are off the planes that are drawn differs from place to place, and so does how much of
/// SfM's depth is wrong. This is learned where the sensor sees the surface, in patches that are hidden from
/// the completion, as a factor of the prior. A patch is laid anywhere; a real hole is where surfaces end,
/// shine, or are far, and the sensor's depth does not correct SfM's there. So the factor is larger, by what
/// recordings with depth held out show.
class CompletionErrors {
 public:
  static float prior(const CompletionEvidence& evidence);

  /// Counts one cell of a hidden patch.
  /// @param error  of the completed inverse depth, relative
  void observe(const CompletionEvidence& evidence, float error, float variance_of_truth);

  /// Updates the factor by what was observed. Call it once for each frame that is learned from. Earlier
  /// frames count for less.
  void learn();

  float variance(const CompletionEvidence& evidence) const { return factor_ * prior(evidence); }

  /// The variance that decides whether depth is published. What was learned may forbid depth, but not allow
  /// it: hidden patches do not show how often real holes contain the end of a surface.
  float cautious(const CompletionEvidence& evidence) const {
    return std::max(factor_, 1.0F) * prior(evidence);
  }

 private:
  float factor_ = 1.0F;
  double count_ = 0.0, squares_ = 0.0;  ///< observed since `factor_` last changed
};

}  // namespace rgbd_sfm_fusion
