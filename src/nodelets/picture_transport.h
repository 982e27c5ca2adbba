// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>

#include <functional>
#include <string>

namespace rgbd_sfm_fusion {

/// A topic of pictures for people, through image_transport, which may compress them with losses. Labels and
/// measures are advertised as plain topics instead: no transport may change a label or a metre.
///
/// The transport for depth refuses pictures, and is left out unless the parameter `disable_pub_plugins` below
/// the topic says something else.
/// @param changed  called after somebody has subscribed, or has gone
image_transport::Publisher advertisePicture(
    const ros::NodeHandle& private_handle, const std::string& name, std::uint32_t queue_size,
    const std::function<void()>& changed = [] {});

}  // namespace rgbd_sfm_fusion
