// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

// Describes the noise of your own sensor in a plain struct. The example is a time-of-flight camera that
// reaches 8 m. The noise of this camera grows less with distance than a structured-light sensor's
// (paper, Eq. 8).
#include <rgbd_sfm_fusion/core.h>
#include <iostream>

using namespace rgbd_sfm_fusion;

int main() {
  DepthNoiseModel noise;
  noise.quadratic = 0.4e-3f;          // [1/m]
  noise.floor = 4e-3f;                // [m]
  noise.common_scale_sigma = 0.002f;  // [1]
  noise.common_offset_sigma = 0.0f;   // [1/m] this camera measures no disparity
  noise.max_range = 8.0f;             // [m]

  FusionOptions options;
  options.noise = noise;
  validate(options);  // throws std::invalid_argument and names what is out of range

  const PinholeCamera camera{640, 480, 525.0, 525.0, 319.5, 239.5};
  DepthFusion ours(camera, options), kinect(camera, FusionOptions());
  RgbdFrame frame;
  frame.stamp = frame.depth_stamp = fromSeconds(1.0);
  for (const float depth : {1.0f, 2.0f, 4.0f, 7.0f}) {
    frame.depth = DepthImage(camera.height, camera.width, depth);
    // Not tracked, so the result is the sensor's alone.
    const auto sigma = [&](DepthFusion& fusion) {
      return std::sqrt(fusion.fuse({}, nullptr, frame).depth.variance(240, 320));
    };
    std::cout << depth << " m: sigma " << sigma(ours) << " m, as a Kinect's " << sigma(kinect) << " m\n";
  }
}
