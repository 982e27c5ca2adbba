// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/text_format.h"

#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kPoseDecimals = 9;
constexpr Stamp kNanoseconds = 1'000'000'000;

}  // namespace

std::string formatStamp(Stamp stamp) {
  if (stamp == kNoStamp) return "";
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << stamp / kNanoseconds << '.' << std::setw(9) << std::setfill('0') << stamp % kNanoseconds;
  return text.str();
}

std::string formatNumber(double value, int decimals) {
  if (std::isnan(value)) return "nan";
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

std::string formatPose(const SE3& T, char separator) {
  const Eigen::Vector4d q = T.rotation().coeffs() * (T.rotation().w() < 0.0 ? -1.0 : 1.0);
  std::string text;
  for (int i = 0; i < 3; ++i) text += formatNumber(T.translation()[i], kPoseDecimals) + separator;
  for (int i = 0; i < 4; ++i)
    text += formatNumber(q[i], kPoseDecimals) + (i < 3 ? std::string(1, separator) : "");
  return text;
}

}  // namespace rgbd_sfm_fusion
