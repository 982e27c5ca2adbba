// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/time_line.h"

namespace rgbd_sfm_fusion::time_line {

bool continues(Stamp last, Stamp stamp) {
  return stamp > last && stamp - last <= kLongestStep;
}

}  // namespace rgbd_sfm_fusion::time_line
