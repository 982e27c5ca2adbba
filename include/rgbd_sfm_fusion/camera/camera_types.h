// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Types of the device layer of an RGB-D camera.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Says to people what keeps a camera from working.
class CameraError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class StreamKind { kColour, kDepth, kInfrared };

constexpr std::array<StreamKind, 3> kAllStreams = {StreamKind::kColour, StreamKind::kDepth,
                                                   StreamKind::kInfrared};

/// "colour", "depth", "infrared"
const char* toText(StreamKind stream);

/// One value for each stream.
template <class Value>
class PerStream {
 public:
  Value& operator[](StreamKind stream) { return values_[static_cast<std::size_t>(stream)]; }
  const Value& operator[](StreamKind stream) const { return values_[static_cast<std::size_t>(stream)]; }

  friend bool operator==(const PerStream& a, const PerStream& b) { return a.values_ == b.values_; }

 private:
  std::array<Value, kAllStreams.size()> values_{};
};

struct StreamMode {
  int width = 640;   ///< [px]
  int height = 480;  ///< [px]
  int fps = 30;      ///< [Hz]
};

inline bool operator==(const StreamMode& a, const StreamMode& b) {
  return a.width == b.width && a.height == b.height && a.fps == b.fps;
}
inline bool operator!=(const StreamMode& a, const StreamMode& b) {
  return !(a == b);
}

/// "640x480@30"
std::string toText(const StreamMode& mode);
std::string toText(const std::vector<StreamMode>& modes);

/// @throws std::invalid_argument unless `text` is like 640x480@30
StreamMode parseStreamMode(const std::string& text);

/// All that can be set. It is set again whenever the device comes back.
struct CameraSettings {
  PerStream<StreamMode> modes;
  bool registration = true;  ///< the device registers depth to colour
  bool frame_sync = true;    ///< the device exposes colour and depth at once, where it can
  bool mirror = false;       ///< images as in a mirror
  bool auto_exposure = true;
  bool auto_white_balance = true;
  int exposure = 0;  ///< [the driver's unit] while auto_exposure is off; 0: leave it as it is
};

inline bool operator==(const CameraSettings& a, const CameraSettings& b) {
  return a.modes == b.modes && a.registration == b.registration && a.frame_sync == b.frame_sync &&
         a.mirror == b.mirror && a.auto_exposure == b.auto_exposure &&
         a.auto_white_balance == b.auto_white_balance && a.exposure == b.exposure;
}

struct DeviceDescription {
  std::string uri;
  std::string name;                          ///< vendor and product
  std::string serial;                        ///< empty where the driver does not tell
  PerStream<std::vector<StreamMode>> modes;  ///< in formats that we read; none: the device has no such stream
};

struct CameraFrame {
  StreamKind stream = StreamKind::kColour;
  cv::Mat
      image;  ///< colour: CV_8UC3, R G B. Depth: CV_16UC1 [mm], 0 = none. Infrared: CV_16UC1. May be a view
  std::uint64_t device_time = 0;  ///< [us]
  int index = 0;                  ///< counted by the device
  bool registered = false;        ///< depth only: its pixels are those of colour
  double horizontal_fov = 0.0;    ///< [rad] of the camera that the pixels belong to
  Stamp stamp = kNoStamp;         ///< by the host's clock
};

}  // namespace rgbd_sfm_fusion
