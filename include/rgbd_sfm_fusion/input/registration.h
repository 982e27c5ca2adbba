// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Whether a depth image says of itself that it is not registered to the colour image: a registered one is in
/// the colour camera's frame. Its camera_info tells nothing: some drivers send the infrared camera's with
/// registered depth, others the same default with both.
/// @param colour_frame, depth_frame  frame_id of the images, without a leading '/'
/// @return what is doubted, and the cure; empty where nothing is, or where one of them has no frame
std::string doubtOfRegistration(const std::string& colour_frame, const std::string& depth_frame);

/// Whether edges of the depth images lie beside those of the colour images. The two cameras are side by side,
/// so that steps of the depth along a row are compared with the gradient along the row, over offsets to both
/// sides. Says nothing where edges are too few, or blurred.
class RegistrationWatch {
 public:
  /// Looks at some of the frames. @param grey, depth  rectified, of one size; depth may be empty
  void add(const GreyImage& grey, const DepthImage& depth);

  /// Of the last seconds: what is doubted, and the cure; empty where nothing is, or not enough is known.
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
