// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/fusion_options.h"

#include "rgbd_sfm_fusion/option_check.h"

namespace rgbd_sfm_fusion {

FusionOptions FusionOptions::paper() {
  FusionOptions options;
  options.noise.floor = 0.0f;
  options.noise.lateral_sigma = 0.0f;
  options.noise.common_scale_sigma = 0.0f;
  options.noise.common_offset_sigma = 0.0f;
  options.noise.far_bias_sigma = 0.0f;
  options.compensate_skew = false;
  options.reprojection.close_gaps = false;
  options.reprojection.pose_covariance = false;
  options.reprojection.lateral_sigma = 0.0f;
  options.recent_keyframe = false;
  options.reject_reflections = false;
  options.rim_width = 0;
  options.scale.estimator = ScaleEstimatorKind::kMeanRatio;
  options.scale.sigma_alpha = false;
  options.scale.filter = false;
  options.calibrate_sfm_variance = false;
  options.gaussian.test_agreement = false;
  options.gaussian.align_locally = false;
  options.gaussian.min_inlier_probability = 0.0;
  options.complete = false;
  return options;
}

void validate(const FusionOptions& options) {
  validate(options.noise);
  requireInRange("reprojection_lateral", options.reprojection.lateral_sigma, 0.0f, 10.0f);
  requireInRange("same_surface", options.reprojection.same_surface, 0.1f, 100.0f);
  requireInRange("rim_width", options.rim_width, 0, 20);
  requireInRange("scale_min_pixels", options.scale.min_pixels, 1, 1000000);
  requireInRange("scale_min_tiles", options.scale.min_tiles, 4, 48);
  requireInRange("max_sfm_only_sigma", options.max_sfm_only_sigma, 0.01, 0.2);
  requireInRange("scale_min_inliers", options.scale.min_inliers, 0.0, 1.0);
  requireInRange("scale_sigma_floor", options.scale.sigma_floor, 0.0, 0.5);
  requireInRange("scale_process_sigma", options.scale.process_sigma, 0.0, 10.0);
  requireInRange("max_chi_squared", options.gaussian.max_chi_squared, 0.1, 1e6);
  requireInRange("max_disagreement", options.gaussian.max_disagreement, 0.0, 1.0);
  requireInRange("max_relative_sigma", options.gaussian.max_relative_sigma, 0.06, 0.2);
  requireInRange("min_inlier_probability", options.gaussian.min_inlier_probability, 0.0, 0.99);
}

}  // namespace rgbd_sfm_fusion
