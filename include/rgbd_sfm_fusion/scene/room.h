// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "rgbd_sfm_fusion/scene/scene.h"

namespace rgbd_sfm_fusion {

/// A furnished room, x 0 to 4 m, y 0 to 6 m, z 0 (floor) to 2.6 m, with a door in its wall at y = 6 m to a
/// second room that ends at y = 9.4 m. There are surfaces of every Material. Takes a second or so.
Scene makeRoom();

/// One room for all of the process, made when it is asked for first.
std::shared_ptr<const Scene> sharedRoom();

}  // namespace rgbd_sfm_fusion
