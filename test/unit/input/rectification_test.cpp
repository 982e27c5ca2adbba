// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/rectification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A Kinect without distortion.
CameraCalibration kinect() {
  CameraCalibration calibration;
  calibration.width = 640;
  calibration.height = 480;
  calibration.distortion_model = "plumb_bob";
  calibration.D = {0, 0, 0, 0, 0};
  calibration.K = {517.3, 0, 318.6, 0, 516.5, 255.3, 0, 0, 1};
  calibration.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  calibration.P = {517.3, 0, 318.6, 0, 0, 516.5, 255.3, 0, 0, 0, 1, 0};
  return calibration;
}

std::vector<CameraCalibration> distortedCameras() {
  CameraCalibration plumb_bob = kinect();
  plumb_bob.D = {0.262383, -0.953104, -0.005358, 0.002628, 1.16331};
  CameraCalibration rational = kinect();
  rational.distortion_model = "rational_polynomial";
  rational.D = {0.4, -0.2, 0.001, -0.002, 0.05, 0.3, -0.1, 0.02};
  CameraCalibration fisheye = kinect();
  fisheye.distortion_model = "equidistant";
  fisheye.D = {0.05, -0.01, 0.002, -0.0005};
  CameraCalibration other_p = plumb_bob;
  other_p.P = {480, 0, 330, 0, 0, 470, 240, 0, 0, 0, 1, 0};
  return {plumb_bob, rational, fisheye, other_p};
}

/// Where a ray (x, y, 1) appears in the raw image, from the models' own definitions.
Eigen::Vector2d distort(const CameraCalibration& calibration, double x, double y) {
  const auto& D = calibration.D;
  const double r2 = x * x + y * y;
  double xd = 0.0, yd = 0.0;
  if (calibration.distortion_model == "equidistant") {
    const double r = std::sqrt(r2), t = std::atan(r), t2 = t * t;
    const double td = t * (1 + t2 * (D[0] + t2 * (D[1] + t2 * (D[2] + t2 * D[3]))));
    xd = r > 0 ? x * td / r : x;
    yd = r > 0 ? y * td / r : y;
  } else {
    double radial = 1 + r2 * (D[0] + r2 * (D[1] + r2 * D[4]));
    if (D.size() == 8) radial /= 1 + r2 * (D[5] + r2 * (D[6] + r2 * D[7]));
    xd = x * radial + 2 * D[2] * x * y + D[3] * (r2 + 2 * x * x);
    yd = y * radial + D[2] * (r2 + 2 * y * y) + 2 * D[3] * x * y;
  }
  return {calibration.K[0] * xd + calibration.K[2], calibration.K[4] * yd + calibration.K[5]};
}

TEST(Rectifier, WhatItSaysIsSeenIsWhatTheRawImageShows) {
  EXPECT_EQ(Rectifier(kinect()).seen(), cv::Rect(0, 0, 640, 480));
  for (const CameraCalibration& calibration : distortedCameras()) {
    const Rectifier rectifier(calibration);
    const DepthImage depth =
        rectifier.rectify(DepthImage(480, 640, 1.0F));  // no depth where the raw image has none
    const cv::Rect& seen = rectifier.seen();
    EXPECT_EQ(cv::countNonZero(depth(seen) == depth(seen)), seen.area());
    EXPECT_GT(seen.area(), 0.85 * cv::countNonZero(depth == depth)) << calibration.distortion_model;
  }
}

TEST(Rectifier, CostsNothingWithoutDistortion) {
  CameraCalibration unset = kinect();
  unset.distortion_model = "";
  unset.D.clear();
  unset.R.fill(0);
  unset.P.fill(0);
  for (const CameraCalibration& calibration : {kinect(), unset}) {
    const Rectifier rectifier(calibration);
    EXPECT_TRUE(rectifier.isIdentity());
    const GreyImage grey(480, 640);
    const DepthImage depth(480, 640);
    EXPECT_EQ(rectifier.rectify(grey).data, grey.data);
    EXPECT_EQ(rectifier.rectify(depth).data, depth.data);
  }
}

TEST(Rectifier, PicturesAreRectifiedAsBrightnessIs) {
  for (const CameraCalibration& calibration : distortedCameras()) {
    const Rectifier rectifier(calibration);
    GreyImage grey(480, 640);
    cv::randu(grey, 0, 256);
    const GreyImage channels[] = {grey, GreyImage(255 - grey), grey};
    cv::Mat rgb;
    cv::merge(channels, 3, rgb);
    cv::Mat rectified[3];
    cv::split(rectifier.rectifyPicture(rgb), rectified);
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(cv::norm(rectified[i], rectifier.rectify(channels[i]), cv::NORM_INF), 0.0) << i;
    EXPECT_THROW(rectifier.rectifyPicture(cv::Mat(240, 320, CV_8UC3)), std::invalid_argument);
  }
}

TEST(Rectifier, CameraIsPOrKWherePIsNotSet) {
  CameraCalibration calibration = kinect();
  calibration.P = {480, 0, 330, 0, 0, 470, 240, 0, 0, 0, 1, 0};
  EXPECT_EQ(Rectifier(calibration).camera(), (PinholeCamera{640, 480, 480, 470, 330, 240}));
  EXPECT_FALSE(Rectifier(calibration).isIdentity());
  calibration.P.fill(0);
  EXPECT_EQ(Rectifier(calibration).camera(), (PinholeCamera{640, 480, 517.3, 516.5, 318.6, 255.3}));
}

TEST(Rectifier, DepthComesFromTheRawPixelOfItsRay) {
  for (const CameraCalibration& calibration : distortedCameras()) {
    const Rectifier rectifier(calibration);
    ASSERT_FALSE(rectifier.isIdentity());
    DepthImage raw(480, 640);  // each pixel holds its own index, exact up to 2^24
    for (int i = 0; i < 480 * 640; ++i) raw(i / 640, i % 640) = static_cast<float>(i);
    const DepthImage depth = rectifier.rectify(raw);
    const PinholeCamera& camera = rectifier.camera();
    int inside = 0;
    for (int y = 0; y < 480; y += 7) {
      for (int x = 0; x < 640; x += 7) {
        const Eigen::Vector3d ray = camera.backProject(x, y, 1.0);
        const Eigen::Vector2d place = distort(calibration, ray.x(), ray.y());
        if (std::isnan(depth(y, x))) {
          EXPECT_TRUE(place.x() < 0 || place.x() > 639 || place.y() < 0 || place.y() > 479) << x << " " << y;
          continue;
        }
        ++inside;
        const int index = static_cast<int>(depth(y, x));
        EXPECT_LE(std::abs(index % 640 - place.x()), 0.501);
        EXPECT_LE(std::abs(index / 640 - place.y()), 0.501);
      }
    }
    EXPECT_GT(inside, 69 * 92 / 2);
  }
}

TEST(Rectifier, DepthIsNeverMixedAcrossEdges) {
  DepthImage raw(480, 640, kNaN);
  for (int i = 0; i < 480 * 640; i += 3) raw(i / 640, i % 640) = i % 2 == 0 ? 1.0f : 4.0f;
  std::set<float> values;
  for (const CameraCalibration& calibration : distortedCameras()) {
    const DepthImage depth = Rectifier(calibration).rectify(raw);
    for (const float z : depth) {
      if (!std::isnan(z)) values.insert(z);
    }
  }
  EXPECT_EQ(values, (std::set<float>{1.0f, 4.0f}));
}

TEST(Rectifier, BrightnessIsThatOfTheRay) {
  for (const CameraCalibration& calibration : distortedCameras()) {
    const Rectifier rectifier(calibration);
    GreyImage raw(480, 640);
    for (int i = 0; i < 480 * 640; ++i)
      raw(i / 640, i % 640) = static_cast<std::uint8_t>(40 + (i % 640) / 8 + (i / 640) / 6);
    const GreyImage grey = rectifier.rectify(raw);
    for (int y = 0; y < 480; y += 7) {
      for (int x = 0; x < 640; x += 7) {
        const Eigen::Vector3d ray = rectifier.camera().backProject(x, y, 1.0);
        Eigen::Vector2d place = distort(calibration, ray.x(), ray.y());
        place = place.cwiseMax(0.0).cwiseMin(Eigen::Vector2d(639, 479));  // the border repeats
        EXPECT_NEAR(grey(y, x), 40 + place.x() / 8 + place.y() / 6, 2.0);
      }
    }
  }
}

TEST(Rectifier, RefusesImagesOfAnotherSize) {
  for (const CameraCalibration& calibration : {kinect(), distortedCameras()[0]}) {
    const Rectifier rectifier(calibration);
    EXPECT_THROW(rectifier.rectify(GreyImage(240, 320)), std::invalid_argument);
    EXPECT_THROW(rectifier.rectify(GreyImage()), std::invalid_argument);
    EXPECT_THROW(rectifier.rectify(DepthImage(640, 480)), std::invalid_argument);
    EXPECT_TRUE(rectifier.rectify(DepthImage()).empty());
  }
}

TEST(Rectifier, NamesTheFieldThatCannotBeUsed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const struct {
    const char* names;
    std::function<void(CameraCalibration&)> spoil;
  } cases[] = {
      {"width", [](auto& c) { c.width = 0; }},
      {"height", [](auto& c) { c.height = -480; }},
      {"K[0]", [](auto& c) { c.K[0] = 0; }},
      {"K[0]", [](auto& c) { c.K[0] = -517; }},
      {"K[1]", [](auto& c) { c.K[1] = 0.5; }},
      {"K[4]", [](auto& c) { c.K[4] = 0; }},
      {"K[5]", [=](auto& c) { c.K[5] = nan; }},
      {"D[2]", [=](auto& c) { c.D[2] = inf; }},
      {"P[5]", [](auto& c) { c.P[5] = 0; }},
      {"P[6]", [=](auto& c) { c.P[6] = -inf; }},
      {"width", [](auto& c) { c.width = 65536; }},
      {"height", [](auto& c) { c.width = 16, c.height = 65537; }},
      {"width", [](auto& c) { c.width = c.height = 8000; }},
      {"K[0]", [](auto& c) { c.K[0] = 1e300; }},
      {"K[2]", [](auto& c) { c.K[2] = -1e30; }},
      {"P[0]", [](auto& c) { c.P[0] = 1e-9; }},
      {"D[1]", [](auto& c) { c.D[1] = -1e300; }},
      {"K, D and P", [](auto& c) { c.P[2] = 6000; }},
      {"D has 3",
       [](auto& c) {
         c.D = {0.1, 0, 0};
       }},
      {"D has 6", [](auto& c) { c.D = {0.1, 0, 0, 0, 0, 0.1}; }},
      {"D has 5",
       [](auto& c) {
         c.distortion_model = "equidistant", c.D = {0, 0, 0, 0, 1};
       }},
      {"D has 0", [](auto& c) { c.distortion_model = "equidistant", c.D.clear(); }},
      {"thin_prism", [](auto& c) { c.distortion_model = "thin_prism", c.D[0] = 0.1; }},
      {"distortion_model", [](auto& c) { c.distortion_model = "", c.D[0] = 0.1; }},
  };
  for (const auto& bad : cases) {
    CameraCalibration calibration = kinect();
    bad.spoil(calibration);
    try {
      Rectifier{calibration};
      ADD_FAILURE() << bad.names;
    } catch (const std::invalid_argument& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("camera_info"), std::string::npos) << message;
      EXPECT_NE(message.find(bad.names), std::string::npos) << message;
      EXPECT_NE(message.find("expected"), std::string::npos) << message;
    }
  }
}

/// Whether two rectifiers do the same to an image of noise.
bool rectifyAlike(const CameraCalibration& a, const CameraCalibration& b) {
  GreyImage image(a.height, a.width);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 256);
  const Rectifier one(a), other(b);
  return one.camera() == other.camera() && one.seen() == other.seen() &&
         cv::norm(one.rectify(image), other.rectify(image), cv::NORM_INF) == 0.0;
}

TEST(Rectifier, TakesWhatDriversWriteBesideTheModel) {
  const CameraCalibration plumb_bob = distortedCameras()[0];
  const std::function<void(CameraCalibration&)> variants[] = {
      [](auto& c) { c.D.resize(8, 0.0); },   // Orbbec
      [](auto& c) { c.D.resize(14, 0.0); },  //
      [](auto& c) { c.R = {0.9999, 0.0067, -0.0033, -0.0067, 0.9999, 0.0069, 0.0033, -0.0069, 0.9999}; },
      [](auto& c) { c.P[3] = -25.8, c.P[7] = -0.09, c.P[11] = 0.88; },  // Orbbec
      [](auto& c) { c.P.fill(0), c.R.fill(0); },
  };
  for (const auto& vary : variants) {
    CameraCalibration calibration = plumb_bob;
    vary(calibration);
    EXPECT_TRUE(rectifyAlike(plumb_bob, calibration));
  }
  CameraCalibration unknown = kinect();
  unknown.distortion_model = "thin_prism";
  EXPECT_TRUE(Rectifier(unknown).isIdentity()) << "with D = 0 the model does not matter";
}

TEST(Rectifier, LeavesDepthAloneThatIsRegisteredToTheRectifiedImage) {
  DepthImage depth(480, 640, 0.0F);
  cv::randu(depth, 1.0F, 3.0F);
  for (const CameraCalibration& calibration : distortedCameras()) {
    EXPECT_EQ(Rectifier(calibration, std::nullopt, true).rectify(depth).data, depth.data);
    EXPECT_NE(Rectifier(calibration).rectify(depth).data, depth.data);
  }
}

TEST(CameraCalibration, SaysWhatIsNotUsedOfIt) {
  CameraCalibration calibration = kinect();
  EXPECT_EQ(unusedParts(calibration), "");
  calibration.R.fill(0);
  EXPECT_EQ(unusedParts(calibration), "");
  calibration.P[3] = -25.8;
  EXPECT_EQ(unusedParts(calibration), "P[3]");
  calibration.R[1] = 1e-3;
  EXPECT_EQ(unusedParts(calibration), "R and P[3]");
}

TEST(CameraCalibration, ASectionSeesAlongTheSameRays) {
  const CameraCalibration full = kinect();
  ImageSection section;
  section.x = 100, section.y = 40, section.width = 400, section.height = 300;
  section.binning_x = section.binning_y = 2;
  const CameraCalibration part = ofSection(full, section);
  EXPECT_EQ(part.width, 200);
  EXPECT_EQ(part.height, 150);
  for (const double u : {100.0, 250.0, 499.0}) {
    const double ray = (u - full.K[2]) / full.K[0];
    // Pixels 100 and 101 are joined to pixel 0, whose centre is at 100.5.
    EXPECT_NEAR(part.K[0] * ray + part.K[2], (u - 100.5) / 2.0, 1e-9);
    EXPECT_NEAR(part.P[0] * ray + part.P[2], (u - 100.5) / 2.0, 1e-9);
  }
  EXPECT_EQ(ofSection(full, {}), full) << "nothing set: all of it";
  section.width = 600;
  EXPECT_THROW(ofSection(full, section), std::invalid_argument) << "beyond the image";
}

TEST(DepthCamera, DiffersFromHalfAPerCentOn) {
  EXPECT_FALSE(differenceOfDepthCamera(kinect(), kinect()));
  CameraCalibration depth = kinect();
  depth.K[0] *= 1.0049;
  depth.K[2] += 3.1;
  EXPECT_FALSE(differenceOfDepthCamera(kinect(), depth));
  const std::function<void(CameraCalibration&)> spoils[] = {
      [](auto& c) { c.K[0] *= 1.0051; }, [](auto& c) { c.K[4] *= 0.9949; }, [](auto& c) { c.K[2] += 3.3; },
      [](auto& c) { c.K[5] -= 2.5; },    [](auto& c) { c.K.fill(0); },
  };
  for (const auto& spoil : spoils) {
    depth = kinect();
    spoil(depth);
    EXPECT_TRUE(differenceOfDepthCamera(kinect(), depth));
  }
  depth.K[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(differenceOfDepthCamera(kinect(), depth));
  depth.height = 240;
  EXPECT_FALSE(differenceOfDepthCamera(kinect(), depth)) << "of another size, which is another question";
}

}  // namespace
}  // namespace rgbd_sfm_fusion
