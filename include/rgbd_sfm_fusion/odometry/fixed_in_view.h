// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/image_pool.h"
#include "rgbd_sfm_fusion/odometry/keyframe.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// What stays where it is in the image while the scene moves on: a gripper, a bumper, the robot's own body.
/// It would hold the poses back, and says nothing of the scene (method.md 7). For each square of the image,
/// there are the odds that it shows such a thing. Each aligned frame that the scene has moved on in is
/// evidence, by a ratio of likelihoods (Wald 1945): the keyframe's pixels are looked for where the pose moves
/// them, and where they were.
class FixedInView {
 public:
  /// @param image  size of the images
  explicit FixedInView(const cv::Size& image);

  /// Nothing is known to be fixed any more.
  void reset();

  /// Takes in an aligned frame, if the scene has moved on in the image since the last one that counted.
  /// @param problem        that was solved, with the keyframe's points
  /// @param T_first_frame  the frame's pose, as of all frames since the last reset()
  void observe(const AlignmentProblem& problem, const AlignmentResult& aligned,
               const KeyframeToTrack& keyframe, const SE3& T_first_frame);

  /// @return for each square of the image (image_squares.h): not 0 if what it shows is fixed; empty if
  ///         nothing is. observe() and reset() do not change what was returned
  const cv::Mat_<std::uint8_t>& squares() const { return squares_; }

  /// @return how many of all squares are fixed, 0 to 1
  double share() const;

 private:
  void compareAtPoints(const AlignmentProblem& problem, const AlignmentResult& aligned,
                       const ReadoutMotion& of_keyframe);
  void compareLeftOut(const AlignmentProblem& problem, const AlignmentResult& aligned,
                      const cv::Mat_<float>& keyframe);
  void decide();

  cv::Mat_<float> log_odds_;        // that a square is fixed
  cv::Mat_<float> evidence_;        // of one frame, to be added to them
  cv::Mat_<std::uint8_t> squares_;  // of the pool; not written again while others hold it
  ImagePool pool_;
  SE3 T_first_last_;  // of the last frame that counted
};

}  // namespace rgbd_sfm_fusion
