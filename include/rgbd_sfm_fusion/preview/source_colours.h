// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {

/// How a source of depth is shown to people, in all pictures and clouds.
struct SourceColour {
  const char* name;  ///< in plain words
  cv::Vec3b rgb;
};

/// By the values of /fusion/provenance. The paper's colours: black none, white sensor, yellow SfM, red fused;
/// and blue completed.
inline const std::array<SourceColour, 5>& sourceColours() {
  static const std::array<SourceColour, 5> colours = {{{"none", {0, 0, 0}},
                                                       {"sensor", {255, 255, 255}},
                                                       {"from motion (SfM)", {255, 255, 0}},
                                                       {"both fused", {255, 0, 0}},
                                                       {"completed", {0, 0, 255}}}};
  return colours;
}

/// An unknown value is shown as none.
inline cv::Vec3b sourceColour(std::uint8_t provenance) {
  return sourceColours()[provenance < sourceColours().size() ? provenance : 0].rgb;
}

/// Image of the same size.
cv::Mat_<cv::Vec3b> paintSources(const cv::Mat_<std::uint8_t>& provenance);

}  // namespace rgbd_sfm_fusion
