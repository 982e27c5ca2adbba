// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <opencv2/imgproc.hpp>
#include <string>

#include "paint_canvas.h"
#include "rgbd_sfm_fusion/scene/random.h"

namespace rgbd_sfm_fusion {
namespace {

/// Draws random shapes and words on an image. Lengths are in metres.
class Printer {
 public:
  Printer(double width, double height, double texel, const Colour& paper, std::uint32_t seed)
      : image(texels(width, height, texel), CV_8UC3, toTexel(paper)), texel_(texel), random_(seed, 0, 2) {}

  double random(double low, double high) {
    return low + (high - low) * static_cast<double>(random_.uniform(counter_++));
  }

  cv::Scalar randomColour() {
    const double grey = random(25, 215), strength = random(0.15, 0.75);
    const auto channel = [&] { return (1.0 - strength) * grey + strength * random(15, 235); };
    const double red = channel(), green = channel();
    return {red, green, channel()};
  }
  cv::Scalar ink() { return cv::Scalar::all(random(15, 60)); }

  cv::Point at(double x, double y) const {
    return {static_cast<int>(x / texel_), static_cast<int>(y / texel_)};
  }

  void rectangle(double x, double y, double width, double height, const cv::Scalar& colour) {
    cv::rectangle(image, at(x, y), at(x + width, y + height), colour, cv::FILLED);
  }

  void shape(double x, double y, double size) {
    const cv::Scalar colour = randomColour();
    const int radius = std::max(2, static_cast<int>(0.5 * size / texel_));
    const int corners = static_cast<int>(random(3, 9));
    if (corners > 6) {
      cv::ellipse(image, at(x, y), {radius, std::max(2, static_cast<int>(radius * random(0.5, 1)))},
                  random(0, 180), 0, 360, colour, cv::FILLED, cv::LINE_AA);
      return;
    }
    std::vector<cv::Point> polygon;
    const double turn = random(0, 6);
    for (int i = 0; i < corners; ++i) {
      const double angle = turn + 2.0 * M_PI * i / corners;
      polygon.push_back(at(x + 0.5 * size * std::cos(angle), y + 0.5 * size * std::sin(angle)));
    }
    cv::fillConvexPoly(image, polygon, colour, cv::LINE_AA);
  }

  /// Random letters from x on, as far as they go within `width`.
  void words(double x, double y, double width, double size, const cv::Scalar& colour) {
    constexpr double kLetterHeight = 22.0;  // [px] of OpenCV's font at scale 1
    const double scale = size / texel_ / kLetterHeight;
    std::string text;
    const auto length = static_cast<std::size_t>(width / (0.85 * size));
    while (text.size() < length)
      text += random(0, 1) < 0.16 ? ' ' : static_cast<char>('A' + static_cast<int>(random(0, 25.99)));
    const int thickness = std::max(1, static_cast<int>(0.14 * size / texel_));
    cv::putText(image, text, at(x, y), cv::FONT_HERSHEY_SIMPLEX, scale, colour, thickness, cv::LINE_AA);
  }

  cv::Mat image;

 private:
  double texel_;  ///< [m]
  CounterRandom random_;
  std::uint32_t counter_ = 0;
};

cv::Mat aged(cv::Mat image, double strength, double texel, std::uint32_t seed) {
  addDirt(image, strength, {0.3 / texel, 0.75, 1.0}, seed);
  return image;
}

}  // namespace

Paint poster(std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    Printer print(width, height, texel, {215, 208, 190}, seed);
    const double frame = 0.03;
    print.rectangle(frame, frame, width - 2 * frame, 0.62 * height, print.randomColour());
    for (int i = 0; i < 40; ++i) {
      const double size = print.random(0.25, 1.0) * print.random(0.05, 0.35) * width;
      print.shape(print.random(frame + 0.5 * size, width - frame - 0.5 * size),
                  print.random(frame + 0.5 * size, 0.64 * height - 0.5 * size), size);
    }
    print.words(frame, 0.76 * height, width - 2 * frame, 0.075 * height, print.ink());
    for (double y = 0.82 * height; y < height - frame; y += 0.04 * height) {
      print.words(frame, y, print.random(0.6, 1.0) * (width - 2 * frame), 0.02 * height, print.ink());
    }
    cv::rectangle(print.image, {0, 0}, {print.image.cols - 1, print.image.rows - 1}, cv::Scalar::all(45), 4);
    return aged(print.image, 0.07, texel, seed);
  };
}

Paint books(std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    Printer print(width, height, texel, {25, 22, 20}, seed);
    for (double x = 0.0; x < width;) {
      const double thickness = print.random(0.015, 0.055), top = print.random(0.02, 0.3) * height;
      const cv::Scalar colour = print.randomColour();
      print.rectangle(x, top, thickness - 0.003, height, colour);
      const cv::Scalar band = print.randomColour();
      print.rectangle(x, top + print.random(0.03, 0.1), thickness - 0.003, print.random(0.005, 0.03), band);
      print.rectangle(x, height - print.random(0.03, 0.08), thickness - 0.003, 0.006, band);
      for (double y = top + 0.12; y < height - 0.10; y += 0.014) {
        const double stroke = print.random(0.2, 0.7) * thickness;
        print.rectangle(x + 0.5 * (thickness - stroke), y, stroke, 0.005, band);
      }
      x += thickness;
    }
    return aged(print.image, 0.09, texel, seed);
  };
}

Paint cardboard(std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    Printer print(width, height, texel, {168, 128, 88}, seed);
    const double size = std::min(width, height);
    print.rectangle(0.0, 0.46 * height, width, 0.07 * size, {205, 185, 140});
    print.rectangle(0.55 * width, 0.58 * height, 0.36 * width, 0.3 * height, {225, 225, 220});
    for (int i = 0; i < 6; ++i) {
      print.words(0.58 * width, (0.63 + 0.04 * i) * height, print.random(0.15, 0.3) * width, 0.02 * size,
                  print.ink());
    }
    print.words(0.06 * width, 0.3 * height, 0.9 * width, 0.16 * size, {70, 45, 30});
    for (int i = 0; i < 18; ++i)
      print.rectangle((0.06 + 0.02 * i) * width, 0.6 * height, print.random(0.2, 0.9) * 0.02 * width,
                      0.12 * height, print.ink());
    for (int i = 0; i < 3; ++i) print.shape((0.12 + 0.13 * i) * width, 0.86 * height, 0.12 * size);
    cv::rectangle(print.image, {0, 0}, {print.image.cols - 1, print.image.rows - 1}, {110, 80, 50}, 2);
    return aged(print.image, 0.11, texel, seed);
  };
}

Paint screen(std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    Printer print(width, height, texel, {22, 23, 26}, seed);
    const double frame = 0.02;
    print.rectangle(frame, frame, width - 2 * frame, height - 2 * frame, {48, 52, 66});
    for (double y = 2.2 * frame; y < height - 2 * frame; y += 0.018) {
      print.words(2 * frame + print.random(0, 0.06), y, print.random(0.1, 0.45) * width, 0.009,
                  {120, 125, 118});
    }
    print.rectangle(0.6 * width, 0.15 * height, 0.33 * width, 0.5 * height, {72, 60, 50});
    for (int i = 0; i < 12; ++i) {
      print.shape(print.random(0.65, 0.88) * width, print.random(0.25, 0.55) * height,
                  print.random(0.02, 0.08));
    }
    return aged(0.8 * print.image, 0.08, texel, seed);
  };
}

Paint view(std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    Printer print(width, height, texel, {165, 185, 205}, seed);
    addDirt(print.image, 0.15, {0.5 / texel, 0.6, 2.5}, seed + 1);
    for (double x = -0.1; x < width; x += print.random(0.1, 0.25)) {
      const double top = print.random(0.3, 0.6) * height, house = print.random(0.12, 0.3);
      print.rectangle(x, top, house, height, print.randomColour());
      for (double y = top + 0.03; y < height; y += 0.07) {
        for (double w = 0.02; w < house - 0.03; w += 0.05)
          print.rectangle(x + w, y, 0.025, 0.04, print.ink());
      }
    }
    for (int i = 0; i < 60; ++i)
      print.shape(print.random(0, width), print.random(0.75, 1.0) * height, print.random(0.03, 0.12));
    for (double x = 0.0; x < width + 0.01; x += 0.5 * width - 0.02)
      print.rectangle(x, 0, 0.04, height, {205, 203, 198});
    for (double y = 0.0; y < height + 0.01; y += 0.5 * height - 0.02)
      print.rectangle(0, y, width, 0.04, {205, 203, 198});
    return aged(print.image, 0.06, texel, seed);
  };
}

}  // namespace rgbd_sfm_fusion
