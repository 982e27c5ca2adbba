// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/compressed_image.h"

#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "compressed_header.h"
#include "rgbd_sfm_fusion/input/image_view.h"
#include "rgbd_sfm_fusion/tools/number_text.h"
#include "rgbd_sfm_fusion/types.h"
#include "rvl.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kDepthHeader = 12;  // [bytes] int32 format, float A, float B; little-endian

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

std::string quoted(const std::string& format) {
  return "\"" + (format.size() <= 60 ? format : format.substr(0, 60) + "…") + "\"";
}

/// The encoding of the image before it was compressed: the part of the format before the ';'. Empty if the
/// format has no ';'.
std::string originalEncoding(const std::string& format) {
  const std::size_t end = format.find(';');
  return end == std::string::npos ? "" : format.substr(0, end);
}

cv::Mat decodeFile(const std::uint8_t* data, std::size_t size) {
  const bool is_png = isPng(data, size);
  if (!is_png && !isJpeg(data, size))
    throw std::invalid_argument("the " + std::to_string(size) + " bytes of data are neither JPEG nor PNG");
  const ImageSize header = is_png ? pngSize(data, size) : jpegSize(data, size);
  requireUsableSize(is_png ? "PNG" : "JPEG", header.width, header.height);
  cv::Mat image;
  try {
    // OpenCV has no view of constant data. A message holds at most 2^30 bytes, so the size fits into an int.
    const cv::Mat view(1, static_cast<int>(size), CV_8UC1, const_cast<std::uint8_t*>(data));
    image = cv::imdecode(view, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {  // leaves the image empty, which is refused below
  }
  if (image.cols != header.width || image.rows != header.height)
    throw std::invalid_argument(std::string(is_png ? "PNG" : "JPEG") + " of " + std::to_string(header.width) +
                                "x" + std::to_string(header.height) + " px in " + std::to_string(size) +
                                " bytes is broken or cut off");
  return image;
}

/// Whether the channels of a colour image are red, green, blue, although OpenCV's decoder takes them for
/// blue, green, red. Reads the format as image_transport's plug-in does.
bool isStoredAsRgb(const std::string& format) {
  const std::string original = originalEncoding(format);
  const bool is_colour = contains(original, "rgb") || contains(original, "bgr");
  return is_colour && original.rfind("bayer", 0) != 0 && !contains(format, "compressed bgr");
}

std::string encodingOf(const cv::Mat& image, const std::string& format) {
  const std::string order = isStoredAsRgb(format) ? "rgb" : "bgr";
  const std::string original = originalEncoding(format);
  switch (image.type()) {
    case CV_8UC1:
      return original.rfind("bayer_", 0) == 0 && contains(original, "8") ? original : "mono8";
    case CV_16UC1:
      return original.rfind("bayer_", 0) == 0 && contains(original, "16") ? original : "mono16";
    case CV_8UC3:
      return order + "8";
    case CV_8UC4:
      return order + "a8";
    case CV_16UC3:
      return order + "16";
    case CV_16UC4:
      return order + "a16";
    default:
      throw std::invalid_argument("the image that " + quoted(format) + " holds has " +
                                  std::to_string(image.channels()) +
                                  " channels of a kind that no camera image has");
  }
}

float floatAt(const std::uint8_t* bytes) {
  std::uint32_t bits = 0;
  for (unsigned i = 0; i < 4; ++i) bits |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// The depth Z = A / (v - B) of each value v; v = 0 means no depth.
cv::Mat fromInverse(const cv::Mat& quantised, float A, float B) {
  if (!std::isfinite(A) || !std::isfinite(B) || !(A > 0.0F))
    throw std::invalid_argument(
        "compressedDepth of 32FC1 has the parameters A = " + numberText(static_cast<double>(A)) +
        " and B = " + numberText(static_cast<double>(B)) + ", expected A > 0");
  cv::Mat_<float> depth(quantised.size());
  for (int y = 0; y < depth.rows; ++y) {
    const auto* values = quantised.ptr<std::uint16_t>(y);
    for (int x = 0; x < depth.cols; ++x)
      depth(y, x) = values[x] == 0 ? kNoDepth : A / (static_cast<float>(values[x]) - B);
  }
  return depth;
}

DecodedImage decodeDepth(const CompressedBytes& bytes) {
  const std::string encoding = originalEncoding(bytes.format);
  if (encoding != "16UC1" && encoding != "mono16" && encoding != "32FC1")
    throw std::invalid_argument("format is " + quoted(bytes.format) +
                                ", expected 16UC1 or 32FC1 before '; compressedDepth'");
  if (bytes.size <= kDepthHeader)
    throw std::invalid_argument("data of compressedDepth are " + std::to_string(bytes.size) +
                                " bytes, expected a header of 12 and an image");
  const std::uint8_t* const image = bytes.data + kDepthHeader;
  const std::size_t size = bytes.size - kDepthHeader;
  const cv::Mat pixels = contains(bytes.format, "rvl") ? decodeRvl(image, size) : decodeFile(image, size);
  if (pixels.type() != CV_16UC1)
    throw std::invalid_argument("compressedDepth holds an image that is not of 16 bits in one channel");
  if (encoding != "32FC1") return {encoding, pixels};
  return {encoding, fromInverse(pixels, floatAt(bytes.data + 4), floatAt(bytes.data + 8))};
}

}  // namespace

DecodedImage decodeImage(const CompressedBytes& bytes) {
  if (contains(bytes.format, "compressedDepth")) return decodeDepth(bytes);
  const cv::Mat pixels = decodeFile(bytes.data, bytes.size);
  return {encodingOf(pixels, bytes.format), pixels};
}

}  // namespace rgbd_sfm_fusion
