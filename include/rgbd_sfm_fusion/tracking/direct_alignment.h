// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/image/brightness.h"
#include "rgbd_sfm_fusion/image/image_pyramid.h"
#include "rgbd_sfm_fusion/tracking/depth_residuals.h"
#include "rgbd_sfm_fusion/tracking/tracking_options.h"
#include "rgbd_sfm_fusion/tracking/tracking_reference.h"

namespace rgbd_sfm_fusion {

/// Points in view that an alignment needs, with its eight unknowns.
constexpr int kMinPoints = 50;

/// Whether light and exposure can change brightness like this. Without a limit, a flat image would fit
/// anything.
bool isPlausible(const Brightness& brightness);

/// How a frame's brightness is related to the keyframe's brightness.
struct Photometry {
  Brightness brightness;
  double noise = 4.0;  ///< [grey levels] standard deviation of a pixel, from all causes
  double alike = 1.0;  ///< so many points of the finest level share their errors, and count as one
};

/// Gives a frame's motion during its readout, for a pose of the frame: the mean velocity since the last frame
/// with a pose is taken to hold.
struct FrameShutter {
  SE3 T_last_keyframe;
  double readout = 0.0;  ///< from the first row to the last, as a share of the time since the last pose

  ReadoutMotion motion(const SE3& T_frame_keyframe) const {
    if (readout == 0.0) return {};
    return {readout * (T_frame_keyframe * T_last_keyframe.inverse()).log()};
  }
};

struct AlignmentResult {
  SE3 T_frame_keyframe;
  Matrix6 covariance = Matrix6::Zero();  ///< of T_frame_keyframe: left perturbation, axes of the frame
  /// Derivative of the error of T_frame_keyframe by an error of the frame's motion during its readout (both:
  /// left perturbation, axes of the frame). Rows above and below the middle have opposite shares of that
  /// motion.
  Matrix6 by_readout = Matrix6::Zero();
  /// The share of sensor depth in the information on the keyframe-side step; 0 without any. And the gradient
  /// of depth's cost by that step, at the result: not 0 where brightness disagrees.
  Matrix6 depth_information = Matrix6::Zero();
  Vector6 depth_pull = Vector6::Zero();
  Photometry photometry;       ///< its noise and its `alike` are those of the residuals on the finest level
  bool is_solvable = false;    ///< false: too few points in view, or none with a gradient
  double share_in_view = 0.0;  ///< of the keyframe's points
  /// Of the points in view: residual below 3 σ, with the noise of the options, or the images' if that is
  /// more. Each point counts by how much of its residual's variance is noise: if its depth leaves open where
  /// it is, it fits everywhere.
  double share_good = 0.0;
  /// Of the squares with sensor depth in both images: those that show one surface. 1 without any, and near 1
  /// with few.
  double share_of_depth = 1.0;
};

/// Normal equations of pose and brightness on one level, H δ = g. δ has a keyframe-side step (x y z rx ry
/// rz), as in T_frame_keyframe · exp(δ)⁻¹, then the steps of gain and offset.
struct NormalEquations {
  using Matrix = Eigen::Matrix<double, 8, 8>;
  using Vector = Eigen::Matrix<double, 8, 1>;
  struct Part {
    Matrix H = Matrix::Zero();
    Vector g = Vector::Zero();
    double share = 0.0;  ///< ReadoutMotion::share() of the part's middle row in the keyframe
  };
  static constexpr int kStrips = PoseEquations::kStrips;  ///< as many of brightness as of depth
  Matrix H = Matrix::Zero();         ///< of brightness, and of depth times as many points as count as one
  Vector g = Vector::Zero();         ///< likewise
  std::array<Part, kStrips> strips;  ///< of the keyframe's brightness, from top to bottom; the last ones may
                                     ///< be empty
  PoseEquations depth;               ///< by itself
  double cost = 0.0;                 ///< as H
  double in_view = 0.0;              ///< points, without those that are white
  double white = 0.0;  ///< points in view where both are too bright, or too dark, to tell anything
  double judged = 0.0, good = 0.0;  ///< points as AlignmentResult::share_good counts them
  /// Sum of the squared residuals of judged points [σ²], each at most the Huber norm's threshold squared.
  double bounded = 0.0;

  double meanCost() const { return cost / std::max(in_view, 1.0); }
};

/// A frame, and the data to align it with. The objects that it refers to have to outlive it.
struct AlignmentProblem {
  const TrackingReference& reference;
  const ImagePyramid& image;  ///< levels of the frame
  const TrackingOptions& options;
  Photometry photometry;  ///< the brightness to start from, and what residuals weigh
  FrameShutter shutter;
  DepthPair depth;  ///< sensor depth of both; alignment minimises its difference as well, except on the
                    ///< coarsest level
};

/// Photometry::alike for a coarser level. It has fewer points on the same surfaces: each shares its error
/// with as many times fewer others.
double pointsThatCountAsOne(const AlignmentProblem& problem, int points_on_level);

/// The equations that align() solves in each of its steps, with the problem's photometry.
/// @param variance_translation  [tracker units] of a pose near T_frame_keyframe: by how far the camera moved,
///                              depth's variance makes residuals uncertain
NormalEquations linearise(const AlignmentProblem& problem, int level, const SE3& T_frame_keyframe,
                          const Eigen::Vector3d& variance_translation);

/// Finds the pose that makes the keyframe's pixels, moved by their depths, look like the frame. The pose
/// minimises the paper's photometric error (Eq. 4) with a Huber norm. Each residual is weighted by its
/// variance, which comes from the pixel's noise and the depth's variance (Engel et al. 2014, Eq. 12–14). An
/// affine brightness is estimated along with the pose, and the difference of sensor depth is minimised as
/// well. Levenberg–Marquardt goes from the coarsest level down to `finest_level`. A last step weighs
/// brightness and depth by the covariances that they have (estimateStep()). The method is inverse
/// compositional: it uses the Jacobian of the keyframe's image.
///
/// @param starts  guesses of T_frame_keyframe, at least one. All are tried on the coarsest level. The best
///                few places go on to the finest level, where the best is taken: of those where they end with
///                a plausible brightness, and the first guess as it was. On the levels between the coarsest
///                and the finest, the search at the best place starts from the first guess as it was,
///                wherever that fits better than what the coarser level has found
AlignmentResult align(const AlignmentProblem& problem, const std::vector<SE3>& starts);

/// As align(), for starts that may all be far away: from where the search ends, it goes on anew, with the
/// brightness there, and with as many points that count as one.
AlignmentResult alignFromFar(const AlignmentProblem& problem, const std::vector<SE3>& starts);

}  // namespace rgbd_sfm_fusion
