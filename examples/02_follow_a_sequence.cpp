// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

// The whole method on one frame after the other, as a camera delivers them. Here the virtual camera renders
// the frames.
#include <rgbd_sfm_fusion/core.h>
#include <rgbd_sfm_fusion/scene/room.h>
#include <rgbd_sfm_fusion/scene/virtual_camera.h>
#include <iostream>

using namespace rgbd_sfm_fusion;

int main() {
  VirtualCamera device({}, sharedRoom());
  const PinholeCamera& view = device.options().camera;

  CameraCalibration calibration;  // what sensor_msgs/CameraInfo has
  calibration.width = view.width;
  calibration.height = view.height;
  calibration.K = {view.fx, 0.0, view.cx, 0.0, view.fy, view.cy, 0.0, 0.0, 1.0};
  Pipeline pipeline(calibration, OdometryOptions(), FusionOptions());

  for (std::uint32_t i = 0; i < 90; ++i) {
    const VirtualFrame image = device.frame(i);
    const PipelineResult result =
        pipeline.process({image.stamp, "rgb8", image.rgb}, {image.depth_stamp, "16UC1", image.depth});
    if (i % 30 != 29) continue;
    const ProvenanceCounts& counts = result.fused.counts;
    std::cout << "frame " << i << " at " << result.mapped.tracked.T_first_frame.translation().transpose()
              << " m: " << counts.sensor_only << " pixels of the sensor alone, " << counts.sfm_only
              << " of SfM alone, " << counts.fused << " of both\n";
  }
}
