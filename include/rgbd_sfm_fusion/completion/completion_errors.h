// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace rgbd_sfm_fusion {

/// [1] Relative variance of inverse depth that the shape of surfaces adds to the variance of measurements.
constexpr float kRoughness = 1e-4F;

/// What decides the variance of a completed depth.
struct CompletionEvidence {
  float misfit = 0.0F;    ///< [1] mean square deviation of the supports from the plane, relative
  float variance = 0.0F;  ///< [1] variance of the supports, relative: see Surfaces
  float unknown = 0.0F;   ///< [1] share of the cells around whose surface is not known
  /// Between SfM's depths, across a gap in the sensor's depth, or continued from one side of a shadow.
  enum Kind : std::uint8_t { kBetween, kInGap, kContinued } kind = kBetween;
};

/// How far surfaces are off the planes that are drawn between supports. It is learned where the sensor sees
/// the surface, in patches that are hidden from the completion. It is used in holes, where the sensor sees
/// nothing. Variances are of inverse depth, and relative. The variance of a completed depth is
///
///     s v + f (misfit + roughness) + u step²
///
/// v is the variance of a support. Half of SfM's variance is common to all supports (s = Evidence::kShare),
/// so that their mean does not reduce it; the other half shows in the misfit. Without SfM, s is 1. Depth
/// between SfM's depths, in gaps without SfM, and in shadows has an f of its own.
///
/// The surface may have ended before the cell, and another one may have begun, a step farther or nearer. The
/// probability of that is u, the share of the cells around whose surface is not known: where supports are
/// few, and at the end of what they support. No hidden patch can show it, since the sensor sees around
/// patches.
class CompletionErrors {
 public:
  /// Counts one cell of a hidden patch.
  /// @param error  of the completed inverse depth, relative
  void observe(const CompletionEvidence& evidence, float error, float variance_of_truth);

  /// Updates the factors by what was observed. Call it once for each frame that is learned from. Earlier
  /// frames count for less.
  void learn();

  /// [1] Variance of inverse depth or of depth, relative to its square.
  float variance(const CompletionEvidence& evidence) const;

 private:
  static constexpr std::size_t kKinds = 3;
  struct Class {
    double factor = 1.0;                ///< f over its prior
    double count = 0.0, squares = 0.0;  ///< observed since `factor` last changed
  };

  float factor(CompletionEvidence::Kind kind) const;

  std::array<Class, kKinds> classes_;  // by CompletionEvidence::Kind
};

}  // namespace rgbd_sfm_fusion
