// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/odometry_options.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "rgbd_sfm_fusion/image/row_bands.h"
#include "rgbd_sfm_fusion/option_check.h"
#include "rgbd_sfm_fusion/simd.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {
namespace {

/// [px] Width and height of the pyramid's last image. The pixels within it can be aligned with: those that
/// have neighbours to all sides, for a gradient.
int minCoarsestSize() {
  return 2 + static_cast<int>(std::ceil(std::sqrt(kMinPoints)));
}

/// With more, a band of rows would be less than a row of the smallest image.
int mostLevels() {
  int levels = 0;
  for (int rows = RowBands::kRows; rows > 0; rows /= 2) ++levels;
  return levels;
}

void validate(const TrackingOptions& options) {
  requireInRange("pyramid_levels", options.pyramid_levels, 1, mostLevels());
  requireInRange("tracking_finest_level", options.finest_level, 0, std::min(3, options.pyramid_levels - 1));
  requireInRange("tracking_image_noise", options.image_noise, 0.1F, 50.0F);
  requireInRange("tracking_min_gradient", options.min_gradient, 0.0F, 50.0F);
  requireInRange("huber_threshold", options.huber_threshold, 0.1F, 100.0F);
  requireInRange("max_iterations", options.max_iterations, 1, 1000);
  requireInRange("min_good_points", options.min_share_of_good_points, 0.0F, 1.0F);
}

void validate(const MappingOptions& options) {
  requireInRange("mapping_min_gradient", options.min_gradient, 1.0F, 50.0F);
  requireInRange("mapping_image_noise", options.image_noise, 0.1F, 50.0F);
  requireInRange("epipolar_noise", options.epipolar_noise, 0.01F, 5.0F);
  requireInRange("min_depth", options.min_depth, 0.01F, 1.0F);
  requireInRange("max_search_length", options.max_search_length, 4, 240);
  requireInRange("max_mismatch", options.max_mismatch, 0.1F, 20.0F);
  requireInRange("min_distinctness", options.min_distinctness, 1.0F, 10.0F);
  requireInRange("confirm_below", options.confirm_below, 0.01F, 100.0F);
  requireInRange("min_observations", options.min_observations, 2, 20);
  requireInRange("mapping max_relative_sigma", options.max_relative_sigma, 0.001F, 1.0F);
}

}  // namespace

void validate(const OdometryOptions& options) {
  validate(options.noise);
  requireInRange("readout_time", options.readout_time, -0.1F, 0.1F);
  validate(options.tracking);
  validate(options.mapping);
  requireInRange("keyframe_distance", options.keyframe.max_distance, 0.01F, 2.0F);
  requireInRange("keyframe_lost", options.keyframe.max_out_of_view, 0.01F, 1.0F);
}

void validate(const OdometryOptions& options, const PinholeCamera& camera) {
  validate(options);
  const bool has_focal_length =
      camera.fx > 0.0 && camera.fy > 0.0 && std::isfinite(camera.fx) && std::isfinite(camera.fy);
  if (!has_focal_length || !std::isfinite(camera.cx) || !std::isfinite(camera.cy))
    throw std::invalid_argument(
        "camera without a focal length or principal point: expected fx, fy > 0 and "
        "finite cx, cy, in pixels");
  // Averages over neighbours are taken of whole blocks, within a few rows.
  const int least = std::max(minCoarsestSize() << (options.tracking.pyramid_levels - 1), kLanes);
  if (std::min(camera.width, camera.height) >= least) return;
  throw std::invalid_argument("images of " + std::to_string(camera.width) + " x " +
                              std::to_string(camera.height) +
                              " pixels are too small to be tracked: expected " + std::to_string(least) +
                              " or more each way; choose a larger mode of the camera");
}

}  // namespace rgbd_sfm_fusion
