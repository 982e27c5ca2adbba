// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenNI.h>

#include "rgbd_sfm_fusion/camera/camera_types.h"

namespace rgbd_sfm_fusion {

/// Whether frames of this format can be turned into what CameraFrame promises.
bool canRead(StreamKind stream, openni::PixelFormat format);

/// Finds the sensor's mode of that size and rate whose format needs the least work.
/// @return false when the sensor has none
bool findVideoMode(const openni::SensorInfo& sensor, StreamKind stream, const StreamMode& mode,
                   openni::VideoMode* video_mode);

/// The frame's pixels: a view of them if they have our format, else converted.
/// @throws CameraError when they can't be read
cv::Mat viewPixels(const openni::VideoFrameRef& frame, cv::Mat* converted);

}  // namespace rgbd_sfm_fusion
