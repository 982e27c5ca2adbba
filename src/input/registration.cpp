// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/registration.h"

namespace rgbd_sfm_fusion {

std::string doubtOfRegistration(const std::string& colour_frame, const std::string& depth_frame) {
  if (colour_frame.empty() || depth_frame.empty() || colour_frame == depth_frame) return "";
  return "depth is in frame " + depth_frame + " and colour in " + colour_frame +
         ", so depth is not registered to colour, and fused with the wrong pixels: switch registration on in "
         "the "
         "driver (depth_registration), or put depth_image_proc/register before";
}

}  // namespace rgbd_sfm_fusion
