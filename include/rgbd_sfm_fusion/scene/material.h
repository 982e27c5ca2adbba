// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace rgbd_sfm_fusion {

/// How a surface looks to a structured-light sensor. Material masks hold these values.
enum class Material : std::uint8_t {
  kNone = 0,    ///< no surface at all
  kMatte = 1,   ///< the only one that the depth sensor sees
  kDark = 2,    ///< absorbs the pattern (paper, experiment 1)
  kShiny = 3,   ///< reflects it away from the camera (paper, experiment 2)
  kSunlit = 4,  ///< outshines it (paper, experiment 3)
  kMirror = 5,  ///< shows the mirrored scene; its true depth is the depth of the glass
};

}  // namespace rgbd_sfm_fusion
