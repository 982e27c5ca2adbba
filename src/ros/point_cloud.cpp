// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/point_cloud.h"

#include <boost/make_shared.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include "rgbd_sfm_fusion/preview/source_colours.h"

namespace rgbd_sfm_fusion {
namespace {

using sensor_msgs::PointField;

static_assert(sizeof(FusedPoint) == 24, "the fields' offsets say where a point's bytes are");

PointField field(const char* name, std::size_t offset, std::uint8_t type) {
  PointField field;
  field.name = name;
  field.offset = static_cast<std::uint32_t>(offset);
  field.datatype = type;
  field.count = 1;
  return field;
}

std::vector<PointField> fieldsOfFusedPoint() {
  return {field("x", offsetof(FusedPoint, x), PointField::FLOAT32),
          field("y", offsetof(FusedPoint, y), PointField::FLOAT32),
          field("z", offsetof(FusedPoint, z), PointField::FLOAT32),
          field("rgb", offsetof(FusedPoint, b), PointField::FLOAT32),
          field("sigma", offsetof(FusedPoint, sigma), PointField::FLOAT32),
          field("provenance", offsetof(FusedPoint, provenance), PointField::UINT8)};
}

cv::Vec3b colourAt(const cv::Mat& picture, int y, int x) {
  if (picture.empty()) return {0, 0, 0};
  if (picture.channels() == 3) return picture.at<cv::Vec3b>(y, x);
  const std::uint8_t grey = picture.at<std::uint8_t>(y, x);
  return {grey, grey, grey};
}

FusedPoint nothing() {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  return {kNone, kNone, kNone, 0, 0, 0, 0, kNone, 0, {}};
}

}  // namespace

sensor_msgs::PointCloud2Ptr toPointCloud(const std_msgs::Header& header, const FusedFrame& fused,
                                         const PinholeCamera& camera, const cv::Mat& picture,
                                         const PointCloudOptions& options) {
  const cv::Mat_<float>& mean = fused.depth.mean;
  if (!picture.empty() && picture.size() != mean.size())
    throw std::invalid_argument("point cloud: the picture is not of the depth's size");
  const int step = std::max(1, options.decimation);
  auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  cloud->header = header;
  cloud->fields = fieldsOfFusedPoint();
  cloud->width = static_cast<std::uint32_t>((mean.cols + step - 1) / step);
  cloud->height = static_cast<std::uint32_t>((mean.rows + step - 1) / step);
  cloud->point_step = sizeof(FusedPoint);
  cloud->row_step = cloud->width * cloud->point_step;
  cloud->is_dense = false;
  cloud->data.resize(cloud->row_step * cloud->height);

  std::uint8_t* destination = cloud->data.data();
  for (int y = 0; y < mean.rows; y += step) {
    for (int x = 0; x < mean.cols; x += step, destination += sizeof(FusedPoint)) {
      const std::uint8_t source = fused.provenance(y, x);
      FusedPoint point = nothing();
      if (mean(y, x) > 0.0F && (options.sources & sourceBit(source)) != 0) {
        const Eigen::Vector3f place = camera.backProject(x, y, static_cast<double>(mean(y, x))).cast<float>();
        const cv::Vec3b rgb = options.colour_by_source ? sourceColour(source) : colourAt(picture, y, x);
        point = {place.x(), place.y(), place.z(), rgb[2],
                 rgb[1],    rgb[0],    0,         std::sqrt(fused.depth.variance(y, x)),
                 source,    {}};
      }
      std::memcpy(destination, &point, sizeof(point));
    }
  }
  return cloud;
}

}  // namespace rgbd_sfm_fusion
