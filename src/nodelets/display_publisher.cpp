// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "display_publisher.h"

#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/Marker.h>

#include "rgbd_sfm_fusion/ros/frustum_marker.h"
#include "rgbd_sfm_fusion/ros/point_cloud.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kQueueSize = 10;
constexpr double kFrustumDepth = 0.3;  // [m]
constexpr int kSensorColumns = 160;    // of points: more of them slow down rviz, and hide each other
constexpr int kAddedColumns = 320;     // these are few, at edges

struct Selection {
  unsigned sources;
  int columns;
};

void publishCloud(const ros::Publisher& publisher, const FusionOutput& output, const Selection& selection) {
  if (publisher.getNumSubscribers() == 0) return;
  PointCloudOptions options;
  options.decimation = (output.fused.depth.mean.cols + selection.columns - 1) / selection.columns;
  options.sources = selection.sources;
  options.colour_by_source = true;
  publisher.publish(toPointCloud(output.header, output.fused, output.rectifier->camera(), {}, options));
}

}  // namespace

DisplayPublisher::DisplayPublisher(const ros::NodeHandle& private_handle) {
  ros::NodeHandle handle(private_handle);
  sensor_ = handle.advertise<sensor_msgs::PointCloud2>("points_sensor", kQueueSize);
  added_ = handle.advertise<sensor_msgs::PointCloud2>("points_added", kQueueSize);
  frustum_ = handle.advertise<visualization_msgs::Marker>("frustum", kQueueSize);
}

void DisplayPublisher::publish(const FusionOutput& output) {
  publishCloud(sensor_, output, {sourceBit(1) | sourceBit(3), kSensorColumns});
  publishCloud(added_, output, {sourceBit(2) | sourceBit(4), kAddedColumns});
  if (frustum_.getNumSubscribers() > 0)
    frustum_.publish(toFrustumMarker(output.header, output.rectifier->camera(), kFrustumDepth));
}

}  // namespace rgbd_sfm_fusion
