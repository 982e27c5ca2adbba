// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Whether the frame_id of a depth image says that it is not registered: registered depth is in the colour
/// camera's frame. The depth camera_info is no evidence. Some drivers send the infrared camera's with
/// registered depth, others send the same default with both.
/// @param colour_frame, depth_frame  frame_id of the images, without a leading '/'
/// @return the doubt and the cure; empty if there is no doubt, or if an image has no frame_id
std::string doubtOfRegistration(const std::string& colour_frame, const std::string& depth_frame);

/// Watches whether the edges of depth images lie beside those of colour images. The two cameras are side by
/// side, so depth steps along a row are compared with the brightness gradient along that row, shifted to both
/// sides. Says nothing if there are too few edges, or if they are blurred.
class RegistrationWatch {
 public:
  /// Uses only some of the frames. @param grey, depth  rectified, of one size; depth may be empty
  void add(const GreyImage& grey, const DepthImage& depth);

  /// About the last seconds: the doubt and the cure; empty if there is no doubt, or too little is known.
  const std::string& doubt() const { return doubt_; }

 private:
  static constexpr int kReach = 32;  ///< [px] to each side

  /// By offset, the sum of gradients there.
  struct Votes {
    std::array<double, 2 * kReach + 1> gradients{};
    std::size_t edges = 0;
  };

  static void vote(const GreyImage& grey, const DepthImage& depth, Votes* votes);
  /// [px] from the image's edges to those of depth; 0: none, or not known
  static int offsetOf(const Votes& votes);
  void judge();

  std::size_t frames_ = 0;
  std::array<Votes, 2> halves_;  ///< of every other frame that was looked at: both have to say the same
  std::string doubt_;
};

}  // namespace rgbd_sfm_fusion
