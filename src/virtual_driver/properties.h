// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "oni_driver_api.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace rgbd_sfm_fusion {

/// Hands out a property's value. `data` has room for `*size` bytes.
template <class T>
OniStatus putProperty(const T& value, void* data, int* size) {
  if (*size != static_cast<int>(sizeof value)) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof value);
  return ONI_STATUS_OK;
}

/// The same of a text, which is cut off where the room ends.
inline OniStatus putProperty(const std::string& text, void* data, int* size) {
  if (*size <= 0) return ONI_STATUS_BAD_PARAMETER;
  const int length = std::min(static_cast<int>(text.size()), *size - 1);
  auto* out = static_cast<char*>(data);
  std::copy_n(text.begin(), length, out);
  out[length] = '\0';
  *size = length + 1;
  return ONI_STATUS_OK;
}

template <class T>
OniStatus takeProperty(const void* data, int size, T& value) {
  if (size != static_cast<int>(sizeof value)) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(&value, data, sizeof value);
  return ONI_STATUS_OK;
}

}  // namespace rgbd_sfm_fusion
