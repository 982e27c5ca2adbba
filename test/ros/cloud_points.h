// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

namespace rgbd_sfm_fusion {

/// Reads a cloud by the names of its fields, as any user of PointCloud2 does.
class CloudPoints {
 public:
  explicit CloudPoints(const sensor_msgs::PointCloud2& cloud) : cloud_(cloud) {}

  float number(const std::string& field, int row, int column) const {
    return read<float>(field, sensor_msgs::PointField::FLOAT32, row, column);
  }
  std::uint8_t label(const std::string& field, int row, int column) const {
    return read<std::uint8_t>(field, sensor_msgs::PointField::UINT8, row, column);
  }
  /// 0xRRGGBB
  std::uint32_t rgb(int row, int column) const {
    const float packed = number("rgb", row, column);
    std::uint32_t value;
    std::memcpy(&value, &packed, sizeof(value));
    return value & 0xFFFFFFU;
  }

 private:
  template <class T>
  T read(const std::string& name, std::uint8_t type, int row, int column) const {
    for (const auto& field : cloud_.fields) {
      if (field.name != name) continue;
      if (field.datatype != type) throw std::invalid_argument(name + " has another type");
      T value;
      const std::size_t offset = static_cast<std::size_t>(row) * cloud_.row_step +
                                 static_cast<std::size_t>(column) * cloud_.point_step + field.offset;
      std::memcpy(&value, &cloud_.data.at(offset), sizeof(value));
      return value;
    }
    throw std::invalid_argument("no field " + name);
  }

  const sensor_msgs::PointCloud2& cloud_;
};

}  // namespace rgbd_sfm_fusion
