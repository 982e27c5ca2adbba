// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rgbd_sfm_fusion {

/// Semi-dense stereo (method.md 7).
struct MappingOptions {
  float min_gradient = 3.0F;  ///< [grey levels / px] least gradient of a pixel whose depth is estimated
  float image_noise = 4.0F;   ///< [grey levels] standard deviation of a pixel's brightness
  float epipolar_noise =
      0.3F;                 ///< [px] standard deviation of an epipolar line's position: poses, calibration
  float min_depth = 0.25F;  ///< nearest depth searched for, as a share of the harmonic mean of depth
  int max_search_length = 240;    ///< [px] of an epipolar segment
  float max_mismatch = 2.5F;      ///< [σ] largest root mean square brightness difference of a match
  float min_distinctness = 1.5F;  ///< the error at any other place, over the match's error
  float confirm_below = 2.0F;     ///< a pixel with less than `min_observations` is observed if the new σ is
                                  ///< below this many times its own; any other pixel, if its σ is halved
  int min_observations = 2;       ///< accepted observations before a depth is published
  bool follow_scatter = true;     ///< published variances follow how far observations scatter
  bool smooth_published = true;   ///< average published depth over neighbours within 4 px
  float max_relative_sigma = 0.2F;  ///< largest σ / depth of a published depth
};

}  // namespace rgbd_sfm_fusion
