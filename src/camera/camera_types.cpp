// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/camera_types.h"

#include <regex>

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
  static const std::regex kPattern("([1-9][0-9]{0,4})x([1-9][0-9]{0,4})@([1-9][0-9]{0,3})");
  std::smatch parts;
  if (!std::regex_match(text, parts, kPattern))
    throw std::invalid_argument("\"" + text + "\" is no mode: expected WIDTHxHEIGHT@RATE, e.g. 640x480@30");
  return {std::stoi(parts[1]), std::stoi(parts[2]), std::stoi(parts[3])};
}

}  // namespace rgbd_sfm_fusion
