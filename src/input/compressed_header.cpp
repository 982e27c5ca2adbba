// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "compressed_header.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint8_t kPngSignature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

// Bytes after 0xff in a JPEG.
constexpr std::uint8_t kBegin = 0xd8, kEnd = 0xd9, kScan = 0xda;
constexpr int kMostScans = 64;  // progressive JPEGs have about ten

[[noreturn]] void refuse(const char* what) {
  throw std::invalid_argument(what);
}

std::int64_t bigEndian(const std::uint8_t* bytes, int count) {
  std::int64_t value = 0;
  for (int i = 0; i < count; ++i) value = (value << 8) | bytes[i];
  return value;
}

/// Markers that have no length and no content: TEM, and the restarts within a scan.
bool standsAlone(std::uint8_t marker) {
  return marker == 0x01 || (marker >= 0xd0 && marker <= 0xd7);
}

bool isFrame(std::uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

}  // namespace

bool isPng(const std::uint8_t* data, std::size_t size) {
  return size >= std::size(kPngSignature) &&
         std::equal(std::begin(kPngSignature), std::end(kPngSignature), data);
}

bool isJpeg(const std::uint8_t* data, std::size_t size) {
  return size >= 3 && data[0] == 0xff && data[1] == kBegin && data[2] == 0xff;
}

ImageSize pngSize(const std::uint8_t* data, std::size_t size) {
  const char header[] = "IHDR";
  if (size < 24 || !std::equal(header, header + 4, data + 12))
    refuse("PNG is cut off or broken: it does not begin with its header");
  return {bigEndian(data + 16, 4), bigEndian(data + 20, 4)};
}

ImageSize jpegSize(const std::uint8_t* data, std::size_t size) {
  ImageSize found;
  int scans = 0;
  for (std::size_t at = 2; at + 1 < size;) {
    const std::uint8_t marker = data[at + 1];
    // Within a scan, all bytes outside markers belong to the image. In the image, 0xff is followed by 0.
    if (data[at] != 0xff || marker == 0xff || marker == 0 || standsAlone(marker)) {
      at += data[at] == 0xff && marker != 0xff ? 2 : 1;
      continue;
    }
    if (marker == kEnd) {
      if (scans == 0 || found.height == 0) refuse("JPEG is broken: it ends without an image");
      return found;
    }
    if (size - at < 4) break;
    const auto length = static_cast<std::size_t>(bigEndian(data + at + 2, 2));
    if (length < 2 || length > size - at - 2) break;
    if (isFrame(marker)) {
      if (length < 8) refuse("JPEG is broken: its header is too short");
      if (found.width != 0) refuse("JPEG is broken: it has two headers");
      found = {bigEndian(data + at + 7, 2), bigEndian(data + at + 5, 2)};
    }
    if (marker == kScan && ++scans > kMostScans) refuse("JPEG has more than 64 scans of one image");
    at += 2 + length;
  }
  refuse("JPEG is cut off: it has no end");
}

}  // namespace rgbd_sfm_fusion
