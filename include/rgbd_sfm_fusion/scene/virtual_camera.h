// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/scene/rasteriser.h"
#include "rgbd_sfm_fusion/scene/scene.h"
#include "rgbd_sfm_fusion/scene/shader.h"
#include "rgbd_sfm_fusion/scene/simulated_colour_sensor.h"
#include "rgbd_sfm_fusion/scene/simulated_depth_sensor.h"
#include "rgbd_sfm_fusion/scene/trajectory.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

struct VirtualCameraOptions {
  std::uint64_t seed = 1;  ///< of trajectory and noise
  double rate = 30.0;      ///< [Hz]
  PinholeCamera camera{640, 480, 525.0, 525.0, 319.5, 239.5};
  Stamp start = 1000 * Stamp{1000000000};  ///< [ns] stamp of frame 0
  DepthSensorOptions depth;
  ColourSensorOptions colour;
  Eigen::Vector2d registration_error = {0.0, 0.0};  ///< [px] by which depth is too far right and down
  double skew = 0.0;                                ///< [s] by which depth is taken after colour
  double readout = 0.0;  ///< [s] from the first row of colour to the last, or negative from the last to the
                         ///< first; the stamp is the middle row's
  Eigen::Vector3d offset = {0.0, 0.0, 0.0};  ///< [m] from the trajectory, in optical axes
};

/// The parts of a frame that are needed. The others are left empty, and take no time.
struct FrameParts {
  bool colour = true;
  bool depth = true;
  bool truth = true;
};

/// One instant: what the camera delivers, and what is true. All images belong to the receiver.
struct VirtualFrame {
  Stamp stamp = kNoStamp;        ///< of the colour image; whole microseconds, like a device's clock
  Stamp depth_stamp = kNoStamp;  ///< of the depth image
  cv::Mat rgb;                   ///< CV_8UC3
  cv::Mat depth;                 ///< CV_16UC1 [mm], 0 = none; registered to the colour image

  SE3 T_world_camera;           ///< at `stamp`
  DepthImage true_depth;        ///< [m], NaN = nothing; at mirrors the depth of the glass
  cv::Mat_<std::uint8_t> mask;  ///< values of Material
};

/// An RGB-D camera that is carried through a rendered scene. Any frame can be asked for at any time. The same
/// options always give it the same bits.
class VirtualCamera {
 public:
  /// @throws std::invalid_argument naming the option that is out of range
  VirtualCamera(const VirtualCameraOptions& options, std::shared_ptr<const Scene> scene);

  const VirtualCameraOptions& options() const { return options_; }

  /// Frames in one pass of the trajectory.
  int framesPerPass() const;

  /// Stamp [ns] of a frame's colour image.
  Stamp stampOf(std::uint32_t index) const;

  /// @param index from 0; the trajectory repeats itself after framesPerPass()
  /// @param frame the memory of its images is used again
  void render(std::uint32_t index, VirtualFrame& frame, const FrameParts& parts = {});
  VirtualFrame frame(std::uint32_t index);

 private:
  SE3 poseAt(double time) const;  ///< T_world_camera
  void shadeRowByRow(double time);
  void measureDepth(std::uint32_t index, double time, bool own_view, VirtualFrame& frame);

  VirtualCameraOptions options_;
  std::shared_ptr<const Scene> scene_;
  std::vector<std::uint8_t> materials_;  ///< values of Material, by surface of the buffers
  HandheldTrajectory trajectory_;
  Rasteriser rasteriser_;
  Shader shader_;
  SimulatedDepthSensor depth_sensor_;
  SimulatedColourSensor colour_sensor_;
  GeometryBuffer geometry_;
  GeometryBuffer depth_geometry_;  ///< used if the depth image has a pose or a camera of its own
  GeometryBuffer band_geometry_;   ///< rows of colour that are read at about the same time
  cv::Mat rgb_, band_rgb_;         ///< before the sensor
};

}  // namespace rgbd_sfm_fusion
