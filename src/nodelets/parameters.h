// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "rgbd_sfm_fusion/settings/settings.h"

namespace rgbd_sfm_fusion {

/// Reads settings from the node's private parameters. A parameter that cannot be used keeps its default, and
/// is reported: a typing error does not end the process. Afterwards the node has none of the other stage's
/// parameters any more.
/// @param stage   kTracker or kFusion
/// @param others  names of private parameters that are not settings, but known to the caller
Settings readParameters(const ros::NodeHandle& private_handle, SettingScope stage,
                        const std::vector<std::string>& others);

}  // namespace rgbd_sfm_fusion
