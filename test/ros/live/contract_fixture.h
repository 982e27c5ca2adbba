// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What the tests of the topics of tracker and fusion have in common: all outputs, and a camera.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>

#include <string>

#include "live_test.h"
#include "rgbd_sfm_fusion/FusionStatistics.h"
#include "rgbd_sfm_fusion/Keyframe.h"
#include "rgbd_sfm_fusion/Scale.h"
#include "rgbd_sfm_fusion/TrackedFrame.h"

namespace rgbd_sfm_fusion {

using Image = sensor_msgs::Image;
using CameraInfo = sensor_msgs::CameraInfo;

/// All outputs.
struct Outputs {
  Inbox<TrackedFrame> frame{"/tracker/frame"};
  Inbox<Keyframe> keyframe{"/tracker/keyframe"};
  Inbox<Image> keyframe_image{"/tracker/keyframe/image"};
  Inbox<Image> keyframe_depth{"/tracker/keyframe/depth"};
  Inbox<Image> keyframe_variance{"/tracker/keyframe/variance"};
  Inbox<CameraInfo> keyframe_info{"/tracker/keyframe/camera_info"};
  Inbox<geometry_msgs::PoseStamped> keyframe_pose{"/tracker/keyframe/pose"};
  Inbox<geometry_msgs::PoseStamped> pose{"/tracker/pose"};
  Inbox<nav_msgs::Odometry> odometry{"/tracker/odometry"};
  Inbox<nav_msgs::Path> path{"/tracker/path"};
  Inbox<Image> mean{"/fusion/mean"};
  Inbox<Image> variance{"/fusion/variance"};
  Inbox<CameraInfo> info{"/fusion/camera_info"};
  Inbox<Image> standard_deviation{"/fusion/standard_deviation"};
  Inbox<Image> provenance{"/fusion/provenance"};
  Inbox<Image> provenance_color{"/fusion/provenance_color"};
  Inbox<Image> disagreement{"/fusion/disagreement"};
  Inbox<Image> sfm_depth{"/fusion/sfm_depth"};
  Inbox<Image> sfm_variance{"/fusion/sfm_variance"};
  Inbox<Scale> scale{"/fusion/scale"};
  Inbox<FusionStatistics> statistics{"/fusion/statistics"};
  Inbox<diagnostic_msgs::DiagnosticArray> diagnostics{"/diagnostics"};

  bool areConnected() const {
    return keyframe.isConnected() && frame.isConnected() && path.isConnected() && pose.isConnected() &&
           odometry.isConnected() && keyframe_image.isConnected() && keyframe_depth.isConnected() &&
           keyframe_variance.isConnected() && keyframe_info.isConnected() && keyframe_pose.isConnected() &&
           mean.isConnected() && variance.isConnected() && info.isConnected() &&
           standard_deviation.isConnected() && provenance.isConnected() && provenance_color.isConnected() &&
           disagreement.isConnected() && sfm_depth.isConnected() && sfm_variance.isConnected() &&
           scale.isConnected() && statistics.isConnected();
  }
};

class ContractTest : public LiveTest {
 protected:
  void SetUp() override {
    start([this] { return outputs_.areConnected(); });
  }

  /// Sends images one by one, each after the one before was fused. @return the last stamp
  Stamp sendFrames(int count, int first = 0) {
    Stamp stamp = kNoStamp;
    for (int frame = first; frame < first + count; ++frame) {
      stamp = live_camera_.send(camera_, frame);
      EXPECT_TRUE(outputs_.mean.at(stamp)) << "frame " << frame << " was not fused";
    }
    return stamp;
  }

  void expectImage(Inbox<Image>& inbox, Stamp stamp, const std::string& encoding) {
    const auto image = inbox.at(stamp);
    ASSERT_TRUE(image) << inbox.topic();
    EXPECT_EQ(image->encoding, encoding) << inbox.topic();
    EXPECT_EQ(image->header.frame_id, camera_.frame_id) << inbox.topic();
    EXPECT_EQ(image->width, 320U) << inbox.topic();
    EXPECT_EQ(image->height, 240U) << inbox.topic();
  }

  Outputs outputs_;
};

}  // namespace rgbd_sfm_fusion
