// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "paint_canvas.h"

namespace rgbd_sfm_fusion {
namespace {

/// Longest noise wave that suits `metres`.
FractalNoise waves(double metres, double texel, double persistence = 0.75, double stretch = 1.0) {
  return {std::max(4.0, metres / texel), persistence, stretch};
}

}  // namespace

Paint plaster(const Colour& colour, std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    cv::Mat image(texels(width, height, texel), CV_8UC3, toTexel(colour));
    addDirt(image, 0.055, waves(1.5, texel, 0.7), seed);
    // Trowel strokes: short, dark and bright ridges.
    addDirt(image, 0.05, waves(0.05, texel, 0.8, 4.0), seed + 1);
    return image;
  };
}

Paint wallpaper(const Colour& ground, const Colour& motif, std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    constexpr double kPeriod = 0.24;
    cv::Mat image = paintEach(width, height, texel, [&](double x, double y) -> Colour {
      const int column = cell(x, kPeriod);
      const double shifted = y + 0.5 * kPeriod * (column & 1);
      const double dx = x - (column + 0.5) * kPeriod, dy = shifted - (cell(shifted, kPeriod) + 0.5) * kPeriod;
      const double radius = std::hypot(dx, dy), angle = std::atan2(dy, dx);
      const double petal = 0.045 * (1.0 + 0.45 * std::cos(5.0 * angle)) + 0.01;
      float ink = 1.0f - smoothStep(radius, petal - 0.004, petal + 0.002);
      if (radius < 0.018) ink = 0.25f;
      const double vine = std::abs(dx - 0.035 * std::sin(2.0 * M_PI * y / 0.31));
      ink = std::max(ink, 0.7f * (1.0f - smoothStep(vine, 0.003, 0.007)));
      return ground + ink * (motif - ground);
    });
    addDirt(image, 0.05, waves(0.8, texel), seed);
    return image;
  };
}

Paint bricks(const Colour& colour, std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    constexpr double kLength = 0.25, kHeight = 0.075, kMortar = 0.006;
    const cv::Mat_<float> wobble = fractalNoise(texels(width, height, texel), waves(0.15, texel), seed + 1);
    cv::Mat image = paintEach(width, height, texel, [&](double x, double y) -> Colour {
      const int tx = std::min(static_cast<int>(x / texel), wobble.cols - 1);
      const int ty = std::min(static_cast<int>(y / texel), wobble.rows - 1);
      const double bend = 0.003 * static_cast<double>(wobble(ty, tx));
      const double wavy_y = y + bend;
      const int course = cell(wavy_y, kHeight);
      const double wavy_x = x + bend + 0.5 * kLength * (course & 1);
      const double gap = std::min(distanceToGrid(wavy_x, kLength), distanceToGrid(wavy_y, kHeight));
      const int number = cell(wavy_x, kLength);
      const float shade = 0.68f + 0.55f * cellRandom(number, course, seed);
      const Colour tint(1.0f, 0.9f + 0.2f * cellRandom(number, course, seed + 7), 0.95f);
      const Colour mortar(150, 145, 135);
      return mortar + smoothStep(gap, kMortar - 0.003, kMortar + 0.003) * (shade * colour.mul(tint) - mortar);
    });
    addDirt(image, 0.10, waves(0.4, texel, 0.85), seed);
    return image;
  };
}

Paint tiles(const Colour& colour, double size, std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    cv::Mat image = paintEach(width, height, texel, [&](double x, double y) -> Colour {
      const double gap = std::min(distanceToGrid(x, size), distanceToGrid(y, size));
      const int column = cell(x, size), row = cell(y, size);
      const bool odd = ((column + row) & 1) != 0;
      const float shade = (odd ? 0.55f : 0.95f) * (0.9f + 0.2f * cellRandom(column, row, seed));
      return smoothStep(gap, 0.002, 0.007) * shade * colour +
             (1.0f - smoothStep(gap, 0.002, 0.007)) * Colour(70, 68, 64);
    });
    addDirt(image, 0.10, waves(0.5, texel, 0.8), seed);
    return image;
  };
}

Paint planks(const Colour& colour, double plank_width, std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    constexpr double kLength = 1.2;
    cv::Mat image = paintEach(width, height, texel, [&](double x, double y) -> Colour {
      const int plank = cell(x, plank_width);
      const double along = y + kLength * static_cast<double>(cellRandom(plank, 0, seed));
      const double gap = std::min(distanceToGrid(x, plank_width), distanceToGrid(along, kLength));
      const int piece = cell(along, kLength);
      const float shade = 0.7f + 0.5f * cellRandom(plank, piece, seed + 3);
      // Growth rings, cut lengthways.
      const double across = x / plank_width + 4.0 * static_cast<double>(cellRandom(plank, piece, seed + 5));
      const double ring = std::sin(14.0 * across + 2.5 * std::sin(2.3 * along + 9.0 * across));
      return smoothStep(gap, 0.001, 0.006) * shade * (1.0f + 0.10f * static_cast<float>(ring)) * colour;
    });
    addDirt(image, 0.10, waves(0.04, texel, 0.8, 0.15), seed);
    addDirt(image, 0.07, waves(0.7, texel), seed + 1);
    return image;
  };
}

Paint wood(const Colour& colour, std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    const cv::Mat_<float> bend =
        fractalNoise(texels(width, height, texel), waves(0.25, texel, 0.4, 3.0), seed);
    cv::Mat image = paintEach(width, height, texel, [&](double x, double y) -> Colour {
      const int tx = std::min(static_cast<int>(x / texel), bend.cols - 1);
      const int ty = std::min(static_cast<int>(y / texel), bend.rows - 1);
      const double ring =
          std::sin(2.0 * M_PI * (y / 0.028 + 0.9 * static_cast<double>(bend(ty, tx))) + 0.7 * x);
      const double edge = std::min(std::min(x, width - x), std::min(y, height - y));
      return (0.86f + 0.15f * static_cast<float>(ring)) * (0.55f + 0.45f * smoothStep(edge, 0.0, 0.008)) *
             colour;
    });
    addDirt(image, 0.08, waves(0.03, texel, 0.8, 8.0), seed + 1);
    addDirt(image, 0.06, waves(0.4, texel), seed + 2);
    return image;
  };
}

Paint fabric(const Colour& colour, const Colour& stripe, std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    cv::Mat image = paintEach(width, height, texel, [&](double x, double y) -> Colour {
      const float weave = 0.9f + 0.1f * static_cast<float>(std::sin(2.0 * M_PI * x / 0.009) *
                                                           std::sin(2.0 * M_PI * y / 0.009));
      const float warp = smoothStep(distanceToGrid(x, 0.17), 0.012, 0.016);
      const float weft = smoothStep(distanceToGrid(y + 0.04, 0.21), 0.018, 0.022);
      return weave * (stripe + (0.35f + 0.65f * warp) * weft * (colour - stripe));
    });
    addDirt(image, 0.13, waves(0.3, texel, 0.8), seed);
    return image;
  };
}

Paint carpet(const Colour& field, const Colour& ornament, std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    cv::Mat image = paintEach(width, height, texel, [&](double x, double y) -> Colour {
      const double border = std::min(std::min(x, width - x), std::min(y, height - y));
      const double dx = x - 0.5 * width, dy = y - 0.5 * height;
      const double diamonds = std::abs(std::fmod(std::abs(dx) + std::abs(dy), 0.30) - 0.15);
      float ink = 1.0f - smoothStep(diamonds, 0.030, 0.036);
      const double spot = std::hypot(distanceToGrid(dx, 0.3), distanceToGrid(dy, 0.3));
      ink = std::max(ink, 0.6f * (1.0f - smoothStep(spot, 0.03, 0.036)));
      if (border < 0.16)
        ink = (border > 0.05 && border < 0.11 && distanceToGrid(x + y, 0.09) > 0.014) ? 1.0f : 0.15f;
      return field + ink * (ornament - field);
    });
    addDirt(image, 0.18, waves(0.25, texel, 0.9), seed);
    return image;
  };
}

Paint metal(const Colour& colour, std::uint32_t seed) {
  return [=](double width, double height, double texel) {
    constexpr double kPlate = 0.3;
    cv::Mat image = paintEach(width, height, texel, [&](double x, double y) -> Colour {
      const double seam = std::min(distanceToGrid(x, kPlate), distanceToGrid(y, kPlate));
      const double rivet = std::hypot(distanceToGrid(x - 0.03, 0.06), distanceToGrid(y, kPlate) - 0.02);
      const float shade = 0.75f + 0.4f * cellRandom(cell(x, kPlate), cell(y, kPlate), seed);
      const float mark = (rivet < 0.005 ? 1.35f : 1.0f) * (0.45f + 0.55f * smoothStep(seam, 0.001, 0.005));
      return shade * mark * colour;
    });
    addDirt(image, 0.12, waves(0.04, texel, 0.85, 12.0), seed);
    addDirt(image, 0.10, waves(0.5, texel), seed + 1);
    return image;
  };
}

}  // namespace rgbd_sfm_fusion
