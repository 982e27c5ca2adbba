// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rgbd_sfm_fusion {

/// Semi-dense stereo (method.md 7).
struct MappingOptions {
  float min_gradient = 3.0F;  ///< [grey levels / px] of a keyframe pixel whose depth is estimated
  float image_noise = 4.0F;   ///< [grey levels] standard deviation of a pixel's brightness
  float epipolar_noise =
      0.3F;                 ///< [px] standard deviation of an epipolar line's position: poses, calibration
  float min_depth = 0.25F;  ///< nearest depth searched for, as a share of the keyframe's median depth
  int max_search_length = 240;      ///< [px] of an epipolar segment
  float max_mismatch = 2.5F;        ///< [σ] root mean square brightness difference of a match
  float min_distinctness = 1.5F;    ///< a match's error must be so much below that of any other place
  float confirm_below = 2.0F;       ///< with less than `min_observations`, a pixel is observed where that has
                                    ///< a σ below so many of its own; else where that halves its σ
  int min_observations = 2;         ///< accepted ones before a depth is published
  bool follow_scatter = true;       ///< published variances follow how far observations scatter
  bool smooth_published = true;     ///< average published depth over neighbours within 4 px
  float max_relative_sigma = 0.2F;  ///< σ / depth of a published depth
};

}  // namespace rgbd_sfm_fusion
