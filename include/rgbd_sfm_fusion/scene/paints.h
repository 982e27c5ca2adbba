// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Reflectance of the things in a room, made up of patterns and of noise at all scales down to the texel.
/// Every function returns a Paint for SceneBuilder. Two things of a kind differ by their `seed`.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/scene/scene_builder.h"

namespace rgbd_sfm_fusion {

using Paint = SceneBuilder::Paint;
using Colour = cv::Vec3f;  ///< RGB, 0 to 255

// Surfaces of buildings and furniture.
Paint plaster(const Colour& colour, std::uint32_t seed);
Paint wallpaper(const Colour& ground, const Colour& motif, std::uint32_t seed);
Paint bricks(const Colour& colour, std::uint32_t seed);
Paint tiles(const Colour& colour, double size, std::uint32_t seed);
Paint planks(const Colour& colour, double width, std::uint32_t seed);  ///< boards run along v
Paint wood(const Colour& colour, std::uint32_t seed);                  ///< grain runs along u
Paint fabric(const Colour& colour, const Colour& stripe, std::uint32_t seed);
Paint carpet(const Colour& field, const Colour& ornament, std::uint32_t seed);
Paint metal(const Colour& colour, std::uint32_t seed);  ///< brushed along u, with rivets and plates

// Things with print on them.
Paint poster(std::uint32_t seed);
Paint books(std::uint32_t seed);  ///< a row of spines, as high as the patch
Paint cardboard(std::uint32_t seed);
Paint screen(std::uint32_t seed);  ///< a display with text and a picture, dim
Paint view(std::uint32_t seed);    ///< out of a window

}  // namespace rgbd_sfm_fusion
