// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace rgbd_sfm_fusion {

/// [1] Variance of surfaces beside that of what is measured on them, relative, of inverse depth.
constexpr float kRoughness = 1e-4F;

/// What a completed depth is told by.
struct CompletionEvidence {
  float distance = 0.0F;  ///< [px] to the nearest support
  float misfit = 0.0F;    ///< [1] mean square deviation of the supports from the plane, relative
  float variance = 0.0F;  ///< [1] of the supports, relative: see Surfaces
  /// Between SfM's depths, across a gap of the sensor's, or continued from its one side.
  enum Kind : std::uint8_t { kBetween, kInGap, kContinued } kind = kBetween;
};

/// How far surfaces are off the planes that are drawn between supports: learned where the sensor sees them,
/// in patches that are hidden from the completion, for the holes, where it does not. Variances are relative,
/// of inverse depth. That of a completed depth is
///
///     v + f (misfit + roughness)
///
/// v is that of its supports, all of it: their errors are alike. f is of the class of distance, of what lies
/// between SfM's depths, in gaps without any, and in shadows apart.
class CompletionErrors {
 public:
  /// What hidden patches of a frame tell; what frames before told counts for less.
  /// @param error  of inverse depth, relative
  void observe(const CompletionEvidence& evidence, float error, float variance_of_truth);

  /// Takes what was observed in account. Once a frame that is learned from.
  void learn();

  /// [1] of inverse depth, and of depth, relative to its square
  float variance(const CompletionEvidence& evidence) const;

 private:
  static constexpr std::size_t kDistances = 4, kKinds = 3;
  struct Class {
    double factor = 1.0;                ///< f over its prior
    double count = 0.0, squares = 0.0;  ///< since the factor was last changed
  };

  static std::size_t classOf(const CompletionEvidence& evidence);
  float factor(std::size_t index) const;

  std::array<Class, kDistances * kKinds> classes_;
};

}  // namespace rgbd_sfm_fusion
