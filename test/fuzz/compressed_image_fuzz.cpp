// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Reads compressed images. The first byte says how many of the next bytes are the format; the others are the
/// data. Only std::invalid_argument may be thrown.
#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "fuzz_input.h"
#include "rgbd_sfm_fusion/input/compressed_image.h"
#include "rgbd_sfm_fusion/input/image_conversion.h"

using namespace rgbd_sfm_fusion;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t format_size = std::min<std::size_t>(data[0], size - 1);
  const std::string format = toText(data + 1, format_size);
  const std::vector<std::uint8_t> bytes(data + 1 + format_size, data + size);
  DecodedImage image;
  try {
    image = decodeImage({format, bytes.data(), bytes.size()});
    toGreyImage(image.pixels, image.encoding);
  } catch (const std::invalid_argument&) {
  }
  try {
    if (!image.pixels.empty()) toDepthImage(image.pixels, image.encoding);
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
