// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/rectification.h"

#include <algorithm>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "rgbd_sfm_fusion/image_size.h"

namespace rgbd_sfm_fusion {
namespace {

bool leavesImageAlone(const CameraCalibration& calibration) {
  CameraCalibration raw = calibration;
  raw.P[0] = 0.0;
  return usedCoefficients(calibration).empty() && rectifiedCamera(calibration) == rectifiedCamera(raw);
}

/// Computes for each rectified pixel the place in the raw image, as x and y [px].
void computeMaps(const CameraCalibration& calibration, const PinholeCamera& camera, cv::Mat& x, cv::Mat& y) {
  const cv::Matx33d raw(calibration.K.data());
  const cv::Matx33d rectified(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  const cv::Size size(camera.width, camera.height);
  if (calibration.distortion_model == "equidistant") {
    const cv::Vec4d distortion(usedCoefficients(calibration).data());
    cv::fisheye::initUndistortRectifyMap(raw, distortion, cv::Matx33d::eye(), rectified, size, CV_32FC1, x,
                                         y);
  } else {
    cv::initUndistortRectifyMap(raw, usedCoefficients(calibration), cv::noArray(), rectified, size, CV_32FC1,
                                x, y);
  }
}

/// Shrinks a rectangle until the raw image shows all of it. Each step takes off the side with the largest
/// share of pixels that are not shown.
cv::Rect largestSeen(const cv::Mat_<float>& x, const cv::Mat_<float>& y) {
  const auto most_x = static_cast<double>(x.cols - 1), most_y = static_cast<double>(x.rows - 1);
  const cv::Mat shown = (x >= 0.0) & (x <= most_x) & (y >= 0.0) & (y <= most_y);  // false where x is NaN
  cv::Mat_<std::int32_t> sums;  // each pixel that is not shown counts 255
  cv::integral(~shown, sums, CV_32S);
  const auto unseen = [&](const cv::Rect& r) {
    return sums(r.br()) - sums(r.y, r.br().x) - sums(r.br().y, r.x) + sums(r.tl());
  };
  cv::Rect area({}, x.size());
  while (!area.empty() && unseen(area) > 0) {
    const auto share = [&](const cv::Rect& side) { return static_cast<double>(unseen(side)) / side.area(); };
    const double left = share({area.x, area.y, 1, area.height});
    const double right = share({area.br().x - 1, area.y, 1, area.height});
    const double top = share({area.x, area.y, area.width, 1});
    const double bottom = share({area.x, area.br().y - 1, area.width, 1});
    const double most = std::max({left, right, top, bottom});
    if (most == left) {
      area += cv::Point(1, 0), area -= cv::Size(1, 0);
    } else if (most == right) {
      area -= cv::Size(1, 0);
    } else if (most == top) {
      area += cv::Point(0, 1), area -= cv::Size(0, 1);
    } else {
      area -= cv::Size(0, 1);
    }
  }
  return area;
}

}  // namespace

Rectifier::Rectifier(const CameraCalibration& calibration, const std::optional<CameraCalibration>& depth,
                     bool depth_is_rectified)
    : resampling_((validate(calibration), depth_is_rectified ? ofRectifiedImages(calibration) : calibration),
                  depth),
      depth_is_rectified_(depth_is_rectified) {
  camera_ = rectifiedCamera(calibration);
  seen_ = {0, 0, camera_.width, camera_.height};
  if (leavesImageAlone(calibration)) return;
  cv::Mat x, y;
  computeMaps(calibration, camera_, x, y);
  seen_ = largestSeen(x, y);
  if (seen_.empty())
    throw std::invalid_argument(
        "camera_info: with this K, D and P the image shows nothing of the rectified one, expected those of a "
        "camera");
  cv::Mat unused;
  cv::convertMaps(x, y, nearest_, unused, CV_16SC2, true);
  cv::convertMaps(x, y, bilinear_coordinates_, bilinear_weights_, CV_16SC2, false);
}

GreyImage Rectifier::rectify(const GreyImage& raw) const {
  return rectifyPicture(raw);
}

cv::Mat Rectifier::rectifyPicture(const cv::Mat& raw) const {
  requireSize("colour image", raw, camera_, "camera_info's");
  if (isIdentity()) return raw;
  cv::Mat rectified;
  cv::remap(raw, rectified, bilinear_coordinates_, bilinear_weights_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return rectified;
}

DepthImage Rectifier::rectify(const DepthImage& raw) const {
  if (raw.empty()) return raw;
  const DepthImage registered = resampling_(raw);
  if (isIdentity() || depth_is_rectified_) return registered;
  DepthImage rectified;
  const auto nothing = cv::Scalar::all(std::numeric_limits<double>::quiet_NaN());
  cv::remap(registered, rectified, nearest_, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT, nothing);
  return rectified;
}

}  // namespace rgbd_sfm_fusion
