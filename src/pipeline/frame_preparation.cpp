// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/pipeline/frame_preparation.h"

#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

/// Runs `function`, and names the image in an error.
template <class Function>
auto naming(const char* image, Function function) {
  try {
    return function();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string(image) + " image: " + error.what());
  }
}

}  // namespace

GreyImage prepareGrey(const Rectifier& rectifier, const RawImage& colour) {
  return naming("colour", [&] {
    const GreyImage prepared = rectifier.rectify(toGreyImage(colour.pixels, colour.encoding));
    return prepared.data == colour.pixels.data ? GreyImage(prepared.clone()) : prepared;
  });
}

DepthImage prepareDepth(const Rectifier& rectifier, const RawImage& depth, double unit, double saturated) {
  if (depth.pixels.empty()) return {};
  return naming("depth", [&] {
    return rectifier.rectify(toDepthImage(depth.pixels, depth.encoding, unit, saturated));
  });
}

RgbdFrame prepareFrame(const Rectifier& rectifier, const RawImage& colour, const RawImage& depth,
                       double saturated) {
  RgbdFrame frame;
  frame.stamp = colour.stamp;
  frame.seen = rectifier.seen();
  frame.grey = prepareGrey(rectifier, colour);
  frame.depth = prepareDepth(rectifier, depth, kMillimetre, saturated);
  frame.depth_stamp = frame.depth.empty() ? kNoStamp : depth.stamp;
  return frame;
}

}  // namespace rgbd_sfm_fusion
