// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/sensor/depth_noise.h"

namespace rgbd_sfm_fusion {

/// What becomes of a keyframe's point that falls between the frame's pixels.
enum class Splat : std::uint8_t {
  kNearest,   ///< it goes to the pixel whose centre is nearest
  kBilinear,  ///< it is shared among the four pixels around it
};

struct ReprojectionOptions {
  Splat splat = Splat::kNearest;
  bool close_gaps = true;       ///< fill one-pixel gaps, and hide depth that shines through them
  bool pose_covariance = true;  ///< let the pose's uncertainty into the variance
  float lateral_sigma = 0.29f;  ///< [px] of rounding to a pixel centre: 1/sqrt(12)
  float same_surface = 3.0f;    ///< [sigma] points that differ by less are of one surface
};

enum class ScaleEstimatorKind : std::uint8_t {
  kMeanRatio,       ///< Σ(d/μ) / |V|: the paper's Eq. 10 with the 1/|V| that its print lacks
  kLeastSquares,    ///< Σ dμ / Σ μ²: the minimiser of the paper's Eq. 9
  kWeightedRobust,  ///< robust fit in inverse depth, where SfM's errors are Gaussian (method.md 4)
};

struct ScaleOptions {
  ScaleEstimatorKind estimator = ScaleEstimatorKind::kWeightedRobust;
  bool sigma_alpha = true;       ///< false: scale, b and c count as known exactly, as in the paper
  bool filter = true;            ///< false: each frame's fit stands alone, as in the paper
  int min_pixels = 200;          ///< [px] with both depths; fewer: the fit is refused, and say nothing of
                                 ///< the frame as a whole (max_disagreement)
  int min_tiles = 6;             ///< tiles (of 8 x 6 in the image) with enough of these pixels that fit
  double min_inliers = 0.3;      ///< [1] share of the pixels that have to fit; the fit starts where so many
                                 ///< agree best (kWeightedRobust only)
  double sigma_floor = 0.001;    ///< [1] relative, of a frame's fit: for errors that all tiles share (not
                                 ///< kWeightedRobust, where σ is the state's)
  double process_sigma = 0.005;  ///< [1/sqrt(s)] random walk of the scale from keyframe to keyframe, relative
};

struct GaussianFusionOptions {
  bool test_agreement = true;  ///< weigh the two depths of a pixel by evidence; false: always average
  double max_chi_squared = 5.0;  ///< [1] (d - m)² / (σ_d² + σ_m²), m = aligned, of a pixel that votes for one
                                 ///< surface (evidence.h); no limit of the pixel's own
  double max_disagreement = 0.5;    ///< [1] share of the pixels that are averaged or flagged; above it the
                                    ///< frame's SfM depth is not used
  double max_relative_sigma = 0.2;  ///< [1] σ / Z of SfM depth: above it, depth is not Gaussian
  double min_inlier_probability = 0.9;  ///< [1] that both depths of a pixel are of one surface, or that
                                        ///< SfM-only depth is of its own; 0: SfM-only depth is not judged,
                                        ///< and not dropped where the image has no texture
  bool align_locally = true;  ///< before averaging, correct SfM depth by the error that its surroundings
                              ///< share; needs `test_agreement`
};

/// All options of fusion. `paper()` is the method as printed, as far as it can be run (config/paper.yaml;
/// method.md says what in print needs care).
struct FusionOptions {
  DepthNoiseModel noise;
  bool compensate_skew = true;  ///< move sensor depth to the colour stamp by the tracked motion
  ReprojectionOptions reprojection;
  bool recent_keyframe = true;     ///< where the keyframe has no estimate, use the one before (not in the
                                   ///< paper, whose recent keyframe is the present one)
  bool reject_reflections = true;  ///< drop SfM depth of reflections: see reflections.h
  int rim_width = 3;  ///< [px] rim of the sensor's holes in which SfM depth is dropped: see markRims()
  ScaleOptions scale;
  bool calibrate_sfm_variance = true;  ///< multiply SfM's variances by the squared spread that the scale's
                                       ///< fit finds (kWeightedRobust only)
  GaussianFusionOptions gaussian;
  double max_sfm_only_sigma = 0.12;  ///< [1] σ / Z of SfM-only depth (if it is judged) and of completed depth
  bool complete = true;              ///< fill holes between measured depths: see depth_completion.h

  static FusionOptions paper();
};

/// @throws std::invalid_argument naming the option, its value and the range it must be in
void validate(const FusionOptions& options);

}  // namespace rgbd_sfm_fusion
