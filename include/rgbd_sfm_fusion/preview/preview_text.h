// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The words of the preview.
#pragma once

#include <array>
#include <string>

#include "rgbd_sfm_fusion/preview/preview.h"

namespace rgbd_sfm_fusion {

/// Shares of all pixels, 0 to 1.
struct PreviewShares {
  std::array<double, 5> by_source{};  ///< by the values of /fusion/provenance; they sum up to 1
  double sensor = 0.0;                ///< pixels that the sensor has measured
  double sfm = 0.0;                   ///< pixels with SfM depth
  double refilled = 0.0;              ///< fused depth's share of the pixels without sensor depth

  double fused() const { return 1.0 - by_source[0]; }
};

PreviewShares sharesOf(const PreviewFrame& frame);

enum class PreviewMood { kGood, kWaiting, kBad };

struct PreviewState {
  PreviewMood mood;
  std::string text;  ///< what happens, and what to do
};

PreviewState describeState(const PreviewFrame& frame);

/// e.g. `29.8 frames/s, 45 ms behind`
std::string speedText(const PreviewFrame& frame);
/// e.g. `refilled: 23 % of the pixels without sensor depth`
std::string refilledText(const PreviewShares& shares);
/// e.g. `scale 1.003 +- 0.002`
std::string scaleText(const ScaleEstimate& scale);
/// e.g. `23 %`, `0.4 %`
std::string percentText(double share);

}  // namespace rgbd_sfm_fusion
