// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include "rgbd_sfm_fusion/ros/bag_input.h"

namespace rgbd_sfm_fusion {

/// Options of the tools that read bags. The options say what is in a bag, if the tool cannot find out.
inline void addTopicOptions(CLI::App* app, BagSelection* selection) {
  app->add_option(
      "--rgb", selection->colour_topic,
      "Topic of the colour images, raw or compressed (default: found, if there is only one choice)");
  app->add_option("--depth", selection->depth_topic,
                  "Topic of the depth images, registered to colour (default: found likewise)");
  app->add_option("--camera-info", selection->camera_info_topic,
                  "Topic of the colour camera's calibration (default: the one beside the images)");
  app->add_option(
      "--calibration", selection->calibration_file,
      "The colour camera's calibration, used instead of camera_info: YAML as camera_calibration and "
      "camera_info_manager write it");
}

}  // namespace rgbd_sfm_fusion
