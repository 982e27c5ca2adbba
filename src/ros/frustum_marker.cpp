// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/frustum_marker.h"

#include <cstddef>

namespace rgbd_sfm_fusion {
namespace {

geometry_msgs::Point toPoint(const Eigen::Vector3d& place) {
  geometry_msgs::Point point;
  point.x = place.x();
  point.y = place.y();
  point.z = place.z();
  return point;
}

}  // namespace

visualization_msgs::Marker toFrustumMarker(const std_msgs::Header& header, const PinholeCamera& camera,
                                           double depth) {
  visualization_msgs::Marker marker;
  marker.header = header;
  marker.ns = "camera";
  marker.type = visualization_msgs::Marker::LINE_LIST;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = 0.02 * depth;  // [m] width of the lines
  marker.color.g = marker.color.b = marker.color.a = 1.0F;

  const double left = -0.5, top = -0.5, right = camera.width - 0.5, bottom = camera.height - 0.5;
  const geometry_msgs::Point centre = toPoint(Eigen::Vector3d::Zero());
  const geometry_msgs::Point corners[] = {
      toPoint(camera.backProject(left, top, depth)), toPoint(camera.backProject(right, top, depth)),
      toPoint(camera.backProject(right, bottom, depth)), toPoint(camera.backProject(left, bottom, depth))};
  for (std::size_t i = 0; i < 4; ++i) {
    marker.points.insert(marker.points.end(), {centre, corners[i], corners[i], corners[(i + 1) % 4]});
  }
  return marker;
}

}  // namespace rgbd_sfm_fusion
