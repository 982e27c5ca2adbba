// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

// Fuses the depth of your own structure from motion with a sensor's depth. The fusion finds the scale.
#include <rgbd_sfm_fusion/core.h>
#include <iostream>

using namespace rgbd_sfm_fusion;

int main() {
  const PinholeCamera camera{640, 480, 525.0, 525.0, 319.5, 239.5};
  const cv::Size size(camera.width, camera.height);

  // A wall 2 m away. The sensor sees only the left part of the wall.
  RgbdFrame frame;
  frame.stamp = frame.depth_stamp = fromSeconds(1.0);
  frame.depth = DepthImage(size, 2.0f);
  frame.depth.colRange(400, 640) = std::numeric_limits<float>::quiet_NaN();

  // SfM sees the whole wall, in units of its own (4 m), with a standard deviation of 1 %.
  auto keyframe = std::make_shared<KeyframeMap>();
  keyframe->stamp = frame.stamp;
  keyframe->camera = camera;
  keyframe->depth = {DepthImage(size, 0.5f), cv::Mat_<float>(size, 0.005f * 0.005f)};

  TrackingResult tracked;  // the frame is the keyframe: T_frame_keyframe is the identity
  tracked.stamp = tracked.keyframe_stamp = frame.stamp;
  tracked.state = TrackingState::kTracking;

  const FusedFrame fused = DepthFusion(camera, FusionOptions()).fuse(tracked, keyframe, frame);
  std::cout << "1 unit of SfM's is " << fused.scale.alpha << " m\n";
  for (const cv::Point pixel : {cv::Point(200, 240), cv::Point(520, 240)})
    std::cout << "depth at x = " << pixel.x << ": " << fused.depth.mean(pixel) << " +- "
              << std::sqrt(fused.depth.variance(pixel)) << " m, source " << int(fused.provenance(pixel))
              << "\n";
}
