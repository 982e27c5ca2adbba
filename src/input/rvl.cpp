// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rvl.h"

#include <stdexcept>

#include "rgbd_sfm_fusion/input/image_view.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kSizeBytes = 8;
constexpr std::size_t kWordBytes = 4;

std::uint32_t littleEndian(const std::uint8_t* bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < kWordBytes; ++i) value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  return value;
}

class Nibbles {
 public:
  Nibbles(const std::uint8_t* data, std::size_t size) : next_(data), end_(data + size) {}

  std::uint32_t number() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 32; shift += 3) {
      const std::uint32_t nibble = take();
      value |= (nibble & 7U) << shift;
      if ((nibble & 8U) == 0) return value;
    }
    throw std::invalid_argument("RVL data hold a number of more than 32 bits");
  }

 private:
  std::uint32_t take() {
    if (left_ == 0) {
      if (static_cast<std::size_t>(end_ - next_) < kWordBytes)
        throw std::invalid_argument("RVL data end before the image does");
      word_ = littleEndian(next_);
      next_ += kWordBytes;
      left_ = 8;
    }
    const std::uint32_t nibble = word_ >> 28U;
    word_ <<= 4U;
    --left_;
    return nibble;
  }

  const std::uint8_t* next_;
  const std::uint8_t* end_;
  std::uint32_t word_ = 0;
  int left_ = 0;
};

}  // namespace

cv::Mat decodeRvl(const std::uint8_t* data, std::size_t size) {
  if (size < kSizeBytes) throw std::invalid_argument("RVL data end before the image's size");
  const std::uint32_t width = littleEndian(data), height = littleEndian(data + kWordBytes);
  requireUsableSize("RVL image", width, height);
  cv::Mat image = cv::Mat::zeros(static_cast<int>(height), static_cast<int>(width), CV_16UC1);
  auto* const pixels = image.ptr<std::uint16_t>();
  const std::size_t count = image.total();
  Nibbles nibbles(data + kSizeBytes, size - kSizeBytes);
  std::size_t at = 0;
  const auto takeRun = [&] {
    const std::size_t length = nibbles.number();
    if (length > count - at)
      throw std::invalid_argument("RVL data hold more pixels than the " + std::to_string(width) + "x" +
                                  std::to_string(height) + " of the image");
    return length;
  };
  std::uint32_t depth = 0;  // only the lowest 16 bits count
  while (at < count) {
    at += takeRun();
    for (std::size_t left = takeRun(); left > 0; --left) {
      const std::uint32_t folded = nibbles.number();  // 0, 1, 2, 3, 4 … stand for 0, -1, 1, -2, 2 …
      depth += (folded >> 1U) ^ (0U - (folded & 1U));
      pixels[at++] = static_cast<std::uint16_t>(depth);
    }
  }
  return image;
}

}  // namespace rgbd_sfm_fusion
