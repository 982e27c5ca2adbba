// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/camera_types.h"

#include <cstdio>

namespace rgbd_sfm_fusion {

const char* toText(StreamKind stream) {
  switch (stream) {
    case StreamKind::kColour:
      return "colour";
    case StreamKind::kDepth:
      return "depth";
    default:
      return "infrared";
  }
}

std::string toText(const StreamMode& mode) {
  return std::to_string(mode.width) + "x" + std::to_string(mode.height) + "@" + std::to_string(mode.fps);
}

std::string toText(const std::vector<StreamMode>& modes) {
  std::string text;
  for (const StreamMode& mode : modes) text += (text.empty() ? "" : ", ") + toText(mode);
  return text.empty() ? "none" : text;
}

StreamMode parseStreamMode(const std::string& text) {
  StreamMode mode{};
  const int count = std::sscanf(text.c_str(), "%5dx%5d@%4d", &mode.width, &mode.height, &mode.fps);
  const bool positive = mode.width > 0 && mode.height > 0 && mode.fps > 0;
  if (count != 3 || !positive || toText(mode) != text)  // toText() writes no spaces, signs and leading zeros
    throw std::invalid_argument("\"" + text + "\" is no mode: expected WIDTHxHEIGHT@RATE, e.g. 640x480@30");
  return mode;
}

}  // namespace rgbd_sfm_fusion
