// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/virtual_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "rgbd_sfm_fusion/scene/random.h"
#include "rgbd_sfm_fusion/scene/room.h"

namespace rgbd_sfm_fusion {
namespace {

VirtualCameraOptions withoutNoise() {
  VirtualCameraOptions options;
  options.depth.noise = false;
  options.colour.blur = false;
  options.colour.noise = 0.0;
  options.colour.exposure_drift = 0.0;
  return options;
}

VirtualFrame rendered(const VirtualCameraOptions& options, std::uint32_t index) {
  return VirtualCamera(options, sharedRoom()).frame(index);
}

bool is(std::uint8_t mask, Material material) {
  return mask == static_cast<std::uint8_t>(material);
}

/// The same bits, NaN included.
bool same(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  const std::size_t bytes = a.elemSize() * static_cast<std::size_t>(a.cols);
  for (int row = 0; row < a.rows; ++row) {
    if (!std::equal(a.ptr(row), a.ptr(row) + bytes, b.ptr(row))) return false;
  }
  return true;
}

bool same(const VirtualFrame& a, const VirtualFrame& b) {
  return a.stamp == b.stamp && a.depth_stamp == b.depth_stamp && same(a.rgb, b.rgb) &&
         same(a.depth, b.depth) && same(a.true_depth, b.true_depth) && same(a.mask, b.mask);
}

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

cv::Mat grey(const VirtualFrame& frame) {
  cv::Mat image;
  cv::cvtColor(frame.rgb, image, cv::COLOR_RGB2GRAY);
  return image;
}

TEST(VirtualCamera, TrueDepthIsThatOfTheRayThroughThePixel) {
  VirtualCamera camera(withoutNoise(), sharedRoom());
  const CounterRandom random(1, 0, 99);
  std::uint32_t counter = 0;
  int mirrors = 0;
  for (std::uint32_t index = 0; index < 600; index += 25) {
    const VirtualFrame frame = camera.frame(index);
    for (int i = 0; i < 400; ++i) {
      const int x = static_cast<int>(640 * random.uniform(counter++));
      const int y = static_cast<int>(480 * random.uniform(counter++));
      const Eigen::Vector3d ray =
          frame.T_world_camera.rotation() * camera.options().camera.backProject(x, y, 1.0);
      const auto hit = intersect(sharedRoom()->patches, frame.T_world_camera.translation(), ray);
      ASSERT_TRUE(hit) << index << ": " << x << ' ' << y;
      EXPECT_NEAR(static_cast<double>(frame.true_depth(y, x)), hit->distance, 3e-6 * hit->distance)
          << index << ": " << x << ' ' << y;
      EXPECT_TRUE(is(frame.mask(y, x), sharedRoom()->patches[hit->patch].material))
          << index << ": " << x << ' ' << y;
      mirrors += is(frame.mask(y, x), Material::kMirror);
    }
  }
  EXPECT_GT(mirrors, 100);
}

TEST(VirtualCamera, MirrorShowsWhatTheReflectedRayMeets) {
  const VirtualFrame frame = rendered(withoutNoise(), 300);
  const PinholeCamera camera = withoutNoise().camera;
  const Eigen::Vector3d n = sharedRoom()->patches[*sharedRoom()->mirror].normal();
  std::vector<double> differences;
  for (int y = 2; y < 478; y += 3) {
    for (int x = 2; x < 638; x += 3) {
      if (!is(frame.mask(y, x), Material::kMirror)) continue;
      const Eigen::Vector3d ray = frame.T_world_camera.rotation() * camera.backProject(x, y, 1.0);
      const Eigen::Vector3d glass =
          frame.T_world_camera.translation() + static_cast<double>(frame.true_depth(y, x)) * ray;
      const auto hit = intersect(sharedRoom()->patches, glass, ray - 2.0 * ray.dot(n) * n, 1e-6);
      ASSERT_TRUE(hit) << x << ' ' << y;
      // A level whose texels are about as large as the pixel.
      const MipTexture& texture = sharedRoom()->textures[hit->patch];
      const MipTexture::Level& level = texture.levels()[1];
      const auto texel = [](double share, int count) {
        return std::clamp(static_cast<int>(share * count), 0, count - 1);
      };
      const int position = texel(hit->v, level.height) * level.width + texel(hit->u, level.width);
      const Texel colour = texture.texels()[level.offset + static_cast<std::size_t>(position)];
      const int green = static_cast<int>((colour >> kTexelFieldBits) & 255U);
      differences.push_back(std::abs(green - frame.rgb.at<cv::Vec3b>(y, x)[1]));
    }
  }
  ASSERT_GT(differences.size(), 1000U);
  EXPECT_LT(quantile(differences, 0.5), 5.0);
}

struct Consistency {
  std::vector<double> moved;    ///< differences of grey between a point in one frame and in the other
  std::vector<double> unmoved;  ///< differences of grey between the same pixels of both
};

Consistency compare(const VirtualFrame& a, const VirtualFrame& b, const PinholeCamera& camera) {
  Consistency result;
  const cv::Mat_<std::uint8_t> grey_a = grey(a), grey_b = grey(b);
  const SE3 T_b_a = b.T_world_camera.inverse() * a.T_world_camera;
  cv::Mat_<float> sample;
  for (int y = 4; y < 476; y += 2) {
    for (int x = 4; x < 636; x += 2) {
      if (is(a.mask(y, x), Material::kMirror)) continue;
      const Eigen::Vector3d point = T_b_a * camera.backProject(x, y, static_cast<double>(a.true_depth(y, x)));
      const Eigen::Vector2d p = camera.project(point);
      if (point.z() < 0.1 || !(p.x() > 2 && p.x() < 637 && p.y() > 2 && p.y() < 477)) continue;
      const float seen =
          b.true_depth(static_cast<int>(std::lround(p.y())), static_cast<int>(std::lround(p.x())));
      if (std::abs(static_cast<double>(seen) - point.z()) > 0.02 * point.z()) continue;  // hidden
      cv::getRectSubPix(grey_b, {1, 1}, {static_cast<float>(p.x()), static_cast<float>(p.y())}, sample,
                        CV_32F);
      result.moved.push_back(std::abs(static_cast<double>(sample(0, 0)) - grey_a(y, x)));
      result.unmoved.push_back(std::abs(grey_b(y, x) - grey_a(y, x)));
    }
  }
  return result;
}

TEST(VirtualCamera, FramesAgreeAboutColourWhereTheySeeTheSamePoint) {
  VirtualCamera camera(withoutNoise(), sharedRoom());
  for (const auto& [from, to] : {std::pair(0U, 15U), std::pair(60U, 75U), std::pair(180U, 190U),
                                 std::pair(400U, 415U), std::pair(3U, 597U)}) {
    Consistency c = compare(camera.frame(from), camera.frame(to), camera.options().camera);
    ASSERT_GT(c.moved.size(), 20000U) << from << ' ' << to;
    const double typical = quantile(c.moved, 0.5);
    EXPECT_LT(typical, 1.5) << from << ' ' << to;
    EXPECT_LT(quantile(c.moved, 0.9), 6.0) << from << ' ' << to;
    // So the geometry matters: without it, differences are larger.
    EXPECT_GT(quantile(c.unmoved, 0.5), 3.0 * typical) << from << ' ' << to;
  }
}

TEST(VirtualCamera, FramesHaveTheSameBitsInWhateverOrder) {
  VirtualCameraOptions options;
  options.skew = -0.01;
  options.registration_error = {0.7, -0.4};
  VirtualCamera forwards(options, sharedRoom()), backwards(options, sharedRoom());
  const VirtualFrame first = forwards.frame(10), second = forwards.frame(30), third = forwards.frame(250);
  VirtualFrame reused;
  backwards.render(250, reused);
  EXPECT_TRUE(same(third, reused));
  backwards.render(30, reused);
  EXPECT_TRUE(same(second, reused));
  backwards.render(10, reused);
  EXPECT_TRUE(same(first, reused));
  options.seed = 2;
  EXPECT_FALSE(same(first, rendered(options, 10)));
}

TEST(VirtualCamera, DepthIsMeasuredOnMatteSurfacesWithinRangeOnly) {
  VirtualCamera camera(VirtualCameraOptions{}, sharedRoom());
  std::array<int, 6> pixels_of{};
  int far = 0, measurable = 0, measured = 0, wrong = 0;
  for (std::uint32_t index = 0; index < 600; index += 30) {
    const VirtualFrame frame = camera.frame(index);
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        const float depth = frame.true_depth(y, x);
        const bool matte = is(frame.mask(y, x), Material::kMatte),
                   has_depth = frame.depth.at<std::uint16_t>(y, x) != 0;
        ++pixels_of.at(frame.mask(y, x));
        far += depth > 5.3f;
        measurable += matte && depth > 0.65f && depth < 4.8f;
        measured += has_depth;
        wrong += has_depth && (!matte || depth > 5.3f || depth < 0.58f);
      }
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(pixels_of[0], 0);
  for (std::size_t material = 1; material < 6; ++material) EXPECT_GT(pixels_of[material], 10000) << material;
  EXPECT_GT(far, 50000);
  EXPECT_GT(measured, 0.85 * measurable);  // the rest is shadow
}

TEST(VirtualCamera, ImagesHaveTextureEverywhereAndAreWellExposed) {
  VirtualCamera camera(withoutNoise(), sharedRoom());
  for (std::uint32_t index = 0; index < 600; index += 60) {
    const cv::Mat image = grey(camera.frame(index));
    cv::Mat dx, dy;
    cv::Sobel(image, dx, CV_32F, 1, 0, 3, 0.125);
    cv::Sobel(image, dy, CV_32F, 0, 1, 3, 0.125);
    const cv::Mat strong = cv::Mat(cv::abs(dx) > 4.0) | cv::Mat(cv::abs(dy) > 4.0);
    EXPECT_GT(cv::countNonZero(strong), 0.08 * 640 * 480) << index;
    EXPECT_LT(cv::countNonZero(strong), 0.6 * 640 * 480) << index;
    for (int y = 0; y < 480; y += 120) {
      for (int x = 0; x < 640; x += 160) {
        EXPECT_GT(cv::countNonZero(strong({x, y, 160, 120})), 100) << index << ": " << x << ' ' << y;
      }
    }
    EXPECT_LT(cv::countNonZero((image < 15) | (image > 235)), 0.005 * 640 * 480) << index;
    EXPECT_NEAR(cv::mean(image)[0], 110.0, 50.0) << index;
  }
}

TEST(VirtualCamera, ColourNoiseIsAsStated) {
  VirtualCameraOptions options = withoutNoise();
  const VirtualFrame clean = rendered(options, 77);
  options.colour.noise = 2.0;
  const VirtualFrame noisy = rendered(options, 77);
  cv::Mat difference;
  cv::subtract(noisy.rgb, clean.rgb, difference, cv::noArray(), CV_32F);
  cv::Scalar mean, sigma;
  cv::meanStdDev(difference, mean, sigma);
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(mean[channel], 0.0, 0.02);
    EXPECT_NEAR(sigma[channel], std::sqrt(4.0 + 1.0 / 12.0), 0.02);
  }
}

TEST(VirtualCamera, RegistrationErrorMovesDepthAlone) {
  VirtualCameraOptions options = withoutNoise();
  options.depth.shadow = options.depth.materials = false;
  const VirtualFrame plain = rendered(options, 100);
  options.registration_error = {3.0, -2.0};
  const VirtualFrame shifted = rendered(options, 100);
  EXPECT_TRUE(same(plain.rgb, shifted.rgb));
  EXPECT_TRUE(same(plain.true_depth, shifted.true_depth));
  EXPECT_TRUE(same(plain.mask, shifted.mask));
  cv::Mat difference;
  cv::absdiff(plain.depth({0, 2, 637, 478}), shifted.depth({3, 0, 637, 478}), difference);
  EXPECT_LT(cv::countNonZero(difference > 1), 100);  // but for outlines that pass through pixel centres
}

TEST(VirtualCamera, SkewTakesDepthLater) {
  VirtualCameraOptions options = withoutNoise();
  const VirtualFrame later = rendered(options, 102);
  options.skew = 2.0 / 30.0;
  const VirtualFrame skewed = rendered(options, 100);
  EXPECT_TRUE(same(skewed.rgb, rendered(withoutNoise(), 100).rgb));
  EXPECT_EQ(skewed.depth_stamp - skewed.stamp, 66667000);
  cv::Mat difference;
  cv::absdiff(skewed.depth, later.depth, difference);
  EXPECT_LT(cv::countNonZero(difference > 1), 200);  // stamps are rounded to microseconds
}

TEST(VirtualCamera, RowsOfARollingShutterAreReadOneAfterAnother) {
  VirtualCameraOptions options = withoutNoise();
  options.readout = 0.1;
  const VirtualFrame rolling = rendered(options, 100);
  const VirtualFrame global = rendered(withoutNoise(), 100);
  EXPECT_TRUE(same(rolling.depth, global.depth));
  EXPECT_TRUE(same(rolling.true_depth, global.true_depth));

  // Half the rows before or after the middle are half the readout before or after the stamp.
  const auto difference = [&rolling](const VirtualFrame& other, int row) {
    return cv::norm(rolling.rgb.row(row), other.rgb.row(row), cv::NORM_L1) / (3.0 * rolling.rgb.cols);
  };
  VirtualCameraOptions faster = withoutNoise();
  faster.rate =
      1.0 / (0.1 * (0.5 - 4.0 / 480.0));  // [Hz] a frame's time is from the first band to the middle
  const auto near = static_cast<std::uint32_t>(std::lround(faster.rate * 100.0 / 30.0));
  options.rate = faster.rate;
  const VirtualFrame middle = rendered(options, near);
  EXPECT_LT(cv::norm(middle.rgb.row(4), rendered(faster, near - 1).rgb.row(4), cv::NORM_L1) / 1920.0, 0.5);
  EXPECT_LT(cv::norm(middle.rgb.row(475), rendered(faster, near + 1).rgb.row(475), cv::NORM_L1) / 1920.0,
            0.5);
  EXPECT_GT(difference(global, 4), 3.0 * difference(global, 244));
}

TEST(VirtualCamera, RefusesNonsense) {
  const auto refused = [](auto change) {
    VirtualCameraOptions options;
    change(options);
    EXPECT_THROW(VirtualCamera(options, sharedRoom()), std::invalid_argument);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([&](VirtualCameraOptions& o) { o.rate = 0.0; });
  refused([&](VirtualCameraOptions& o) { o.rate = nan; });
  refused([&](VirtualCameraOptions& o) { o.camera.width = 0; });
  refused([&](VirtualCameraOptions& o) { o.camera.fx = nan; });
  refused([&](VirtualCameraOptions& o) { o.camera.cx = nan; });
  refused([&](VirtualCameraOptions& o) { o.start = -1; });
  refused([&](VirtualCameraOptions& o) { o.registration_error.x() = nan; });
  refused([&](VirtualCameraOptions& o) { o.skew = nan; });
  refused([&](VirtualCameraOptions& o) { o.readout = nan; });
  refused([&](VirtualCameraOptions& o) { o.start = 0, o.skew = -0.1; });
  refused([&](VirtualCameraOptions& o) { o.colour.noise = -1.0; });
  refused([&](VirtualCameraOptions& o) { o.colour.exposure_drift = nan; });
  EXPECT_THROW(VirtualCamera(VirtualCameraOptions{}, nullptr), std::invalid_argument);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
