// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>

namespace rgbd_sfm_fusion {

/// Natural logarithm, to 0.06: exact at powers of two, linear between them.
inline float roughLogarithm(float value) {
  std::int32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return static_cast<float>(bits - 0x3f800000) * (0.69314718f / 0x800000);
}

}  // namespace rgbd_sfm_fusion
