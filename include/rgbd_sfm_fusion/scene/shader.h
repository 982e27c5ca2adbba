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
  /// @param rgbx CV_8UC4, of the buffer's size; allocated if need be
  void shade(const Scene& scene, const GeometryBuffer& geometry, cv::Mat& rgbx);

 private:
  /// Where each pixel of a run lies in its texture.
  struct Footprints {
    std::vector<float> u, v;    ///< texture coordinates, 0 to 1
    std::vector<float> du, dv;  ///< from one of its taps to the next, along the footprint's long axis
    std::vector<float> taps;    ///< how many, whole
    std::vector<float> level;   ///< of the texture, continuous
  };

  void shadeRun(const ProjectedPatch& patch, const MipTexture& texture, int row, int x0, int x1,
                std::uint8_t* rgbx);

  Footprints footprints_;
};

}  // namespace rgbd_sfm_fusion
