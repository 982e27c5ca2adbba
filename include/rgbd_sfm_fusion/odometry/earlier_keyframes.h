// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/odometry/keyframe.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// Poses that alignment starts from after a loss: the given pose, and poses turned up, down and sideways by
/// up to `steps` times 0.1 rad. The camera turns in its place, and about the point that it looks at.
/// @param depth  distance of the point that the camera looks at
std::vector<SE3> turned(const SE3& T_camera_keyframe, int steps, double depth);

/// The keyframes before the present one, for a camera that comes back to one of them after a loss.
class EarlierKeyframes {
 public:
  void remember(const Place& keyframe);
  void clear() { places_.clear(); }

  struct Found {
    std::shared_ptr<const Place> place;
    AlignmentResult aligned;  ///< without a shutter: the image's velocity is not known
  };
  /// A keyframe that the image shows, with nothing much in front of it. A call looks at two keyframes, which
  /// takes as long as tracking half a dozen frames. The next call looks at the next two, from the latest to
  /// the oldest and round again.
  /// @param cells        sensor depth of the image; may be empty
  /// @param depth_sigma  of their inverse depths' differences [1/tracker unit]
  std::optional<Found> find(const ImagePyramid& image, const TrackingOptions& options,
                            const DepthCells& cells, float depth_sigma);

 private:
  std::deque<std::shared_ptr<const Place>> places_;  // the latest first
  std::size_t next_ = 0;                             // the next one to look at
};

}  // namespace rgbd_sfm_fusion
