// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/preview/preview_text.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/tools/text_format.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kMostLatency = 100.0;  // [s]
constexpr double kClockTick = 0.1;      // [s]

bool hasDepth(const DepthImage& image, int y, int x) {
  return !image.empty() && image(y, x) > 0.0F;
}

}  // namespace

PreviewShares sharesOf(const PreviewFrame& frame) {
  const cv::Mat_<std::uint8_t>& provenance = frame.fused.provenance;
  PreviewShares shares;
  if (provenance.empty()) return shares;
  std::array<std::uint64_t, 5> by_source{};
  std::uint64_t sensor = 0, sfm = 0, refilled = 0;
  for (int y = 0; y < provenance.rows; ++y) {
    for (int x = 0; x < provenance.cols; ++x) {
      const std::size_t source = provenance(y, x) < by_source.size() ? provenance(y, x) : 0;
      const bool measured = hasDepth(frame.sensor, y, x);
      ++by_source[source];
      sensor += measured ? 1U : 0U;
      sfm += hasDepth(frame.fused.sfm.mean, y, x) ? 1U : 0U;
      refilled += !measured && source != 0 ? 1U : 0U;
    }
  }
  const std::uint64_t all = provenance.total();
  const auto share = [](std::uint64_t part, std::uint64_t of) {
    return of == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(of);
  };
  for (std::size_t i = 0; i < by_source.size(); ++i) shares.by_source[i] = share(by_source[i], all);
  shares.sensor = share(sensor, all);
  shares.sfm = share(sfm, all);
  shares.refilled = share(refilled, all - sensor);
  return shares;
}

PreviewState describeState(const PreviewFrame& frame) {
  switch (frame.state) {
    case TrackingState::kLost:
      return {PreviewMood::kBad, "lost: sensor depth only"};
    case TrackingState::kInitialising:
      return {PreviewMood::kWaiting, "starting: needs light, texture and sensor depth"};
    case TrackingState::kTracking:
      break;
  }
  if (frame.fused.sfm_rejected) return {PreviewMood::kBad, "SfM contradicts the sensor: sensor depth only"};
  if (!frame.fused.scale.hasScale()) return {PreviewMood::kWaiting, "starting: needs motion"};
  return {PreviewMood::kGood, "tracking"};
}

std::string speedText(const PreviewFrame& frame) {
  const std::string rate =
      std::isfinite(frame.rate) ? formatNumber(frame.rate, 1) + " frames/s" : "rate not known yet";
  if (!std::isfinite(frame.latency)) return rate + ", offline";
  // A simulated clock ticks coarsely, and may be a little behind. Or there is none.
  if (std::abs(frame.latency) > kMostLatency || frame.latency < -kClockTick) return rate + ", clock not set";
  return rate + ", " + formatNumber(1e3 * std::max(frame.latency, 0.0), 0) + " ms behind";
}

std::string refilledText(const PreviewShares& shares) {
  if (shares.sensor >= 1.0) return "nothing to refill: the sensor sees everything";
  return "refilled: " + percentText(shares.refilled) + " of the pixels without sensor depth";
}

std::string scaleText(const ScaleEstimate& scale) {
  if (!scale.hasScale()) return "scale of SfM: not known yet";
  return "scale of SfM: " + formatNumber(scale.alpha, 3) + " +- " + formatNumber(scale.sigma, 3);
}

std::string percentText(double share) {
  const double percent = 100.0 * share;
  const bool small = percent > 0.0 && percent < 9.95;
  return formatNumber(percent, small ? 1 : 0) + " %";
}

}  // namespace rgbd_sfm_fusion
