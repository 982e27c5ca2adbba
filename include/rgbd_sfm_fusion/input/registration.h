// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Whether the frame_id of a depth image says that the image is not registered: registered depth is in the
/// colour camera's frame. The depth camera_info is no evidence. Some drivers send the infrared camera's
/// camera_info with registered depth; others send the same default with depth and with colour.
/// @param colour_frame, depth_frame  frame_id of the images, without a leading '/'
/// @return the doubt and the cure; empty if there is no doubt, or if an image has no frame_id
std::string doubtOfRegistration(const std::string& colour_frame, const std::string& depth_frame);

/// Watches whether the edges of depth images lie beside those of colour images. The two cameras are side by
/// side, so depth steps along a row are compared with the brightness gradient along that row, shifted to both
/// sides. Says nothing if the edges are too few or blurred.
class RegistrationWatch {
 public:
  /// Uses only some of the frames. @param grey, depth  rectified, of one size; depth may be empty
  void add(const GreyImage& grey, const DepthImage& depth);

  /// About the last seconds: the doubt and the cure; empty if there is no doubt, or too little is known.
  const std::string& doubt() const { return doubt_; }

 private:
  static constexpr int kReach = 32;  ///< [px] to each side

  /// The sums of gradients, by offset.
  struct Votes {
    std::array<double, 2 * kReach + 1> gradients{};
    std::size_t edges = 0;
  };

  static void vote(const GreyImage& grey, const DepthImage& depth, Votes* votes);
  /// [px] from the image's edges to depth's edges; 0: no offset, or not known
  static int offsetOf(const Votes& votes);
  void judge();

  std::size_t frames_ = 0;
  std::array<Votes, 2> halves_;  ///< each of every other frame that was looked at; both halves have to agree
  std::string doubt_;
};

}  // namespace rgbd_sfm_fusion
