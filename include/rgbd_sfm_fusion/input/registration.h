// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rgbd_sfm_fusion {

/// Whether a depth image says of itself that it is not registered to the colour image: a registered one is in
/// the colour camera's frame. Its camera_info tells nothing: some drivers send the infrared camera's with
/// registered depth, others the same default with both.
/// @param colour_frame, depth_frame  frame_id of the images, without a leading '/'
/// @return what is doubted, and the cure; empty where nothing is, or where one of them has no frame
std::string doubtOfRegistration(const std::string& colour_frame, const std::string& depth_frame);

}  // namespace rgbd_sfm_fusion
