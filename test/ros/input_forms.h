// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The same images in all the forms that other drivers and recordings use, for tests offline and live.
#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fake_camera.h"

namespace rgbd_sfm_fusion {

/// The messages of one frame.
struct SentFrame {
  sensor_msgs::ImagePtr colour, depth;
  sensor_msgs::CameraInfo info;
  std::optional<sensor_msgs::CameraInfo> depth_info;
};

inline SentFrame sentFrame(const FakeCamera& camera, int frame) {
  return {camera.colour(frame), camera.depthImage(frame), camera.info(frame), std::nullopt};
}

/// @param extension  .png or .jpg: the kind of file that the pixels are made into
/// @param header     [bytes] before that file
inline sensor_msgs::CompressedImage compress(const sensor_msgs::ImageConstPtr& image,
                                             const std::string& format, std::size_t header,
                                             const std::string& extension = ".png") {
  sensor_msgs::CompressedImage compressed;
  compressed.header = image->header;
  compressed.format = format;
  std::vector<std::uint8_t> file;
  cv::imencode(extension, viewImage(image), file);
  compressed.data.assign(header, 0);
  compressed.data.insert(compressed.data.end(), file.begin(), file.end());
  return compressed;
}

/// 16UC1 depth in the form that compressedDepth uses for 32FC1: inverse depth in steps of 1 / A, up to 10 m.
inline sensor_msgs::CompressedImage compressAsInverse(const sensor_msgs::ImageConstPtr& millimetres) {
  const float A = 100.0F * 101.0F, B = 1.0F - A / 10.0F;
  const cv::Mat_<std::uint16_t> depth = viewImage(millimetres);
  cv::Mat_<std::uint16_t> steps(depth.size(), std::uint16_t{0});
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      if (depth(y, x) == 0) continue;
      steps(y, x) =
          static_cast<std::uint16_t>(std::lround(A / (0.001F * static_cast<float>(depth(y, x))) + B));
    }
  }
  sensor_msgs::CompressedImage compressed =
      compress(toImage(millimetres->header, "mono16", steps), "32FC1; compressedDepth png", 12);
  std::memcpy(compressed.data.data() + 4, &A, sizeof A);  // little endian, as the format demands
  std::memcpy(compressed.data.data() + 8, &B, sizeof B);
  return compressed;
}

inline void setPixels(const std::string& encoding, const cv::Mat& pixels, sensor_msgs::Image* image) {
  const std_msgs::Header header = image->header;
  *image = *toImage(header, encoding, pixels);
}

/// One way to send a frame.
struct InputForm {
  std::string name;
  std::function<void(SentFrame&)> change;
  bool has_same_bits;  ///< after decoding
};

/// The forms that need no setting. The fake camera's images are grey, and so are its Bayer patterns.
inline std::vector<InputForm> inputForms() {
  using Frame = SentFrame;
  std::vector<InputForm> forms;
  const auto addColour = [&](const std::string& encoding, int code, int depth = CV_8U, bool same = true) {
    forms.push_back({encoding,
                     [=](Frame& frame) {
                       cv::Mat pixels = viewImage(frame.colour).clone();
                       if (code >= 0) cv::cvtColor(pixels, pixels, code);
                       if (depth == CV_16U) pixels.convertTo(pixels, CV_16U, 257.0);
                       setPixels(encoding, pixels, frame.colour.get());
                     },
                     same});
  };
  constexpr int kAsItIs = -1;
  addColour("bgr8", cv::COLOR_RGB2BGR);
  addColour("rgba8", cv::COLOR_RGB2RGBA);
  addColour("bgra8", cv::COLOR_RGB2BGRA);
  addColour("mono8", cv::COLOR_RGB2GRAY);
  addColour("mono16", cv::COLOR_RGB2GRAY, CV_16U);
  addColour("rgb16", kAsItIs, CV_16U);
  addColour("bgra16", cv::COLOR_RGB2BGRA, CV_16U);
  addColour("8UC1", cv::COLOR_RGB2GRAY);
  addColour("8UC3", cv::COLOR_RGB2BGR);
  addColour("8UC4", cv::COLOR_RGB2BGRA);
  for (const char* pattern : {"bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"})
    addColour(pattern, cv::COLOR_RGB2GRAY, CV_8U, false);
  addColour("bayer_grbg16", cv::COLOR_RGB2GRAY, CV_16U, false);
  for (const int luma : {0, 1}) {
    const std::string encoding = luma == 0 ? "yuv422_yuy2" : "yuv422";
    forms.push_back({encoding,
                     [=](Frame& frame) {
                       cv::Mat grey, channels[2];
                       cv::cvtColor(viewImage(frame.colour), grey, cv::COLOR_RGB2GRAY);
                       channels[luma] = grey;
                       channels[1 - luma] = cv::Mat(grey.size(), CV_8U, cv::Scalar(128));
                       cv::Mat pixels;
                       cv::merge(channels, 2, pixels);
                       setPixels(encoding, pixels, frame.colour.get());
                     },
                     true});
  }
  const auto swapBytes = [](sensor_msgs::Image* image) {
    for (std::size_t i = 0; i + 1 < image->data.size(); i += 2) std::swap(image->data[i], image->data[i + 1]);
    image->is_bigendian = 1;
  };
  forms.push_back({"mono16 in big endian",
                   [=](Frame& frame) {
                     cv::Mat grey;
                     cv::cvtColor(viewImage(frame.colour), grey, cv::COLOR_RGB2GRAY);
                     grey.convertTo(grey, CV_16U, 257.0);
                     setPixels("mono16", grey, frame.colour.get());
                     swapBytes(frame.colour.get());
                   },
                   true});
  forms.push_back({"depth in big endian", [=](Frame& frame) { swapBytes(frame.depth.get()); }, true});
  forms.push_back({"depth as mono16", [](Frame& frame) { frame.depth->encoding = "mono16"; }, true});
  const auto toMetres = [](Frame& frame) {
    const cv::Mat_<std::uint16_t> counts = viewImage(frame.depth);
    cv::Mat_<float> metres(counts.size());
    for (int y = 0; y < counts.rows; ++y) {
      for (int x = 0; x < counts.cols; ++x)
        metres(y, x) = counts(y, x) == 0 ? std::numeric_limits<float>::quiet_NaN()
                                         : static_cast<float>(counts(y, x)) / 1000.0F;
    }
    setPixels("32FC1", metres, frame.depth.get());
  };
  forms.push_back({"depth as 32FC1", toMetres, true});
  forms.push_back({"depth as 32FC1 in big endian",
                   [=](Frame& frame) {
                     toMetres(frame);
                     auto& data = frame.depth->data;
                     for (std::size_t i = 0; i + 3 < data.size(); i += 4)
                       std::reverse(data.begin() + static_cast<std::ptrdiff_t>(i),
                                    data.begin() + static_cast<std::ptrdiff_t>(i + 4));
                     frame.depth->is_bigendian = 1;
                   },
                   true});
  forms.push_back({"rows that end in padding",
                   [](Frame& frame) {
                     sensor_msgs::Image& image = *frame.colour;
                     std::vector<std::uint8_t> padded;
                     for (std::uint32_t y = 0; y < image.height; ++y) {
                       const auto row = image.data.begin() + static_cast<std::ptrdiff_t>(y * image.step);
                       padded.insert(padded.end(), row, row + static_cast<std::ptrdiff_t>(image.step));
                       padded.insert(padded.end(), 24, 200);
                     }
                     image.step += 24;
                     image.data = padded;
                   },
                   true});

  const auto addInfo = [&](const std::string& name,
                           const std::function<void(sensor_msgs::CameraInfo&)>& change) {
    forms.push_back({name, [=](Frame& frame) { change(frame.info); }, true});
  };
  addInfo("R and P[3] of another camera", [](auto& info) {
    info.R = {0.9999, 0.01, 0.0, -0.01, 0.9999, 0.0, 0.0, 0.0, 1.0};
    info.P[3] = -25.8;
    info.P[11] = 0.89;
  });
  addInfo("R and P of zeros", [](auto& info) {
    info.R.fill(0.0);
    info.P.fill(0.0);
  });
  addInfo("eight coefficients of plumb_bob", [](auto& info) { info.D.assign(8, 0.0); });
  addInfo("an unknown model of zeros", [](auto& info) { info.distortion_model = "Brown Conrady"; });
  addInfo("no model and no coefficients", [](auto& info) {
    info.distortion_model.clear();
    info.D.clear();
  });
  addInfo("a region of a larger image", [](auto& info) {
    info.width = 640;
    info.height = 480;
    info.roi.x_offset = 100;
    info.roi.y_offset = 50;
    info.roi.width = 320;
    info.roi.height = 240;
    for (const std::size_t i : {2U}) info.K[i] = info.P[i] = info.K[i] + 100.0;
    info.K[5] = info.P[6] = info.K[5] + 50.0;
  });
  addInfo("binning", [](auto& info) {
    info.width *= 2;
    info.height *= 2;
    info.binning_x = info.binning_y = 2;
    for (const std::size_t i : {0U, 4U}) info.K[i] *= 2.0;
    for (const std::size_t i : {0U, 5U}) info.P[i] *= 2.0;
    // The centre of two joined pixels lies between their centres.
    for (const std::size_t i : {2U, 5U}) info.K[i] = 2.0 * (info.K[i] + 0.5) - 0.5;
    for (const std::size_t i : {2U, 6U}) info.P[i] = 2.0 * (info.P[i] + 0.5) - 0.5;
  });
  forms.push_back({"the infrared camera's camera_info with registered depth",
                   [](Frame& frame) {
                     frame.depth_info = frame.info;
                     frame.depth_info->K[0] = frame.depth_info->P[0] = 1.12 * frame.info.K[0];
                   },
                   true});
  forms.push_back({"frames with a leading slash",
                   [](Frame& frame) {
                     for (std::string* id : {&frame.colour->header.frame_id, &frame.depth->header.frame_id,
                                             &frame.info.header.frame_id})
                       *id = "/" + *id;
                   },
                   true});
  forms.push_back({"depth of half the size",
                   [](Frame& frame) {
                     cv::Mat pixels = viewImage(frame.depth).clone();
                     cv::resize(pixels, pixels, cv::Size(), 0.5, 0.5, cv::INTER_NEAREST);
                     setPixels("16UC1", pixels, frame.depth.get());
                     sensor_msgs::CameraInfo info = frame.info;
                     info.width /= 2;
                     info.height /= 2;
                     for (const std::size_t i : {0U, 2U, 4U, 5U}) info.K[i] *= 0.5;
                     for (const std::size_t i : {0U, 2U, 5U, 6U}) info.P[i] *= 0.5;
                     frame.depth_info = info;
                   },
                   false});
  forms.push_back({"depth of the middle rows",
                   [](Frame& frame) {
                     const cv::Mat pixels = viewImage(frame.depth).rowRange(20, 220).clone();
                     setPixels("16UC1", pixels, frame.depth.get());
                     sensor_msgs::CameraInfo info = frame.info;
                     info.height = 200;
                     info.K[5] -= 20.0;
                     info.P[6] -= 20.0;
                     frame.depth_info = info;
                   },
                   false});
  return forms;
}

}  // namespace rgbd_sfm_fusion
