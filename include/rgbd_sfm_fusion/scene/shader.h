// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/scene/rasteriser.h"
#include "rgbd_sfm_fusion/scene/scene.h"

namespace rgbd_sfm_fusion {

/// Colours what a Rasteriser has drawn: textures are filtered over each pixel's footprint, and outlines are
/// smoothed by four samples per pixel.
class Shader {
 public:
  /// @param rgb CV_8UC3, of the buffer's size; allocated if need be
  void shade(const Scene& scene, const GeometryBuffer& geometry, cv::Mat& rgb);

 private:
  void shadeRow(const Scene& scene, const GeometryBuffer& geometry, int row, std::uint32_t* rgbx) const;

  void smoothRow(const Scene& scene, const GeometryBuffer& geometry, int row, cv::Vec3b* rgb);

  cv::Mat_<cv::Vec4b> rgbx_;           ///< colour at the centre of each pixel
  std::vector<std::uint8_t> outline_;  ///< for each pixel of a row: whether it is on an outline
};

}  // namespace rgbd_sfm_fusion
