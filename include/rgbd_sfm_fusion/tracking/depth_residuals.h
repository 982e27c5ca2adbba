// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/sensor/depth_noise.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Mean inverse depth of the sensor in squares of an image (image_squares.h) that are whole. On a plane,
/// inverse depth is linear in the pixel coordinates. So the mean is exact at the square's centre, and values
/// interpolated between centres are exact, too.
class DepthCells {
 public:
  /// @param depth  H x W [m], NaN without depth; squares across a step or a hole get no inverse depth
  void compute(const DepthImage& depth, const PinholeCamera& camera, const DepthNoiseModel& noise);
  /// Those of the image's squares that are marked have no inverse depth any more.
  /// @param squares  as forEachMarked() takes them
  void leaveOut(const cv::Mat_<std::uint8_t>& squares);
  void clear() { inverse_depth_.release(); }

  bool empty() const { return inverse_depth_.empty(); }
  const cv::Mat_<float>& inverseDepth() const { return inverse_depth_; }  ///< [1/m] NaN without depth
  const PinholeCamera& camera() const { return camera_; }  ///< a camera whose pixels are the squares

 private:
  PinholeCamera camera_;
  cv::Mat_<float> inverse_depth_;
};

/// Sensor depth of a keyframe, and of the frame to align with it. Times are shares of the frame interval.
struct DepthPair {
  const DepthCells* keyframe = nullptr;
  const DepthCells* frame = nullptr;  ///< null: none
  double age = 0.0;                   ///< age of the frame's depth at the time of its colour image
  double age_sigma = 0.0;
  float sigma = 0.002F;  ///< [1/m] standard deviation of the difference of two squares

  bool exists() const { return keyframe && frame && !keyframe->empty() && !frame->empty(); }
};

/// Normal equations of a pose.
struct PoseEquations {
  struct Part {
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
  };
  static constexpr int kStrips = 24;  ///< they tell how alike the residuals of neighbours are
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  std::array<Part, kStrips> strips;  ///< of the keyframe's squares, from top to bottom; some may be empty
  double cost = 0.0;
  double compared = 0.0, agreeing = 0.0;  ///< squares: those that have depth in both; those of one surface
};

/// Linearises the difference in inverse depth between the frame's squares and the keyframe's squares, which
/// are moved to the frame: r = ρ_frame(π(p)) - 1/z of p = T_frame_keyframe · p_keyframe. This difference
/// tells a turn from a move sideways, which brightness hardly does. Residuals have Tukey's weight. Each
/// variance has a part for the error of the depth's time.
/// @param T_frame_last  motion since the last frame
/// @return equations of a keyframe-side step δ, as in T_frame_keyframe · exp(δ)⁻¹
PoseEquations depthEquations(const DepthPair& depth, const SE3& T_frame_keyframe, const SE3& T_frame_last);

}  // namespace rgbd_sfm_fusion
