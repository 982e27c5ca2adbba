// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Reading and writing are the same under a locale with a decimal comma.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "../temporary_path.h"
#include "comma_locale.h"
#include "rgbd_sfm_fusion/input/camera_calibration.h"
#include "rgbd_sfm_fusion/scene/virtual_camera.h"
#include "rgbd_sfm_fusion/settings/settings.h"
#include "rgbd_sfm_fusion/settings/written_files.h"
#include "rgbd_sfm_fusion/tools/number_text.h"
#include "rgbd_sfm_fusion/tools/progress.h"
#include "rgbd_sfm_fusion/tools/text_format.h"
#include "rgbd_sfm_fusion/tools/tum_sequence.h"
#include "rgbd_sfm_fusion/tools/tum_writer.h"

namespace rgbd_sfm_fusion {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

/// The text files of a sequence's folder, and numbers that were read from them.
std::string writtenSequence() {
  const fs::path folder = temporaryPath("locale_test");
  fs::remove_all(folder);
  TumWriter writer(folder, {1280, 1024, 1050.5, 1051.25, 639.5, 511.5}, 1000.0, "test");
  writer.add(1'234'567'890'123'456'000, cv::Mat(2, 2, CV_8UC3, cv::Scalar::all(7)), 1'234'567'890'123'456'000,
             cv::Mat(2, 2, CV_16U, cv::Scalar(2000)),
             SE3(Eigen::Quaterniond::Identity(), {1234.5, 0.25, 0.5}));
  writer.finish();
  std::string text;
  for (const char* name : {"calib.txt", "associations.txt", "groundtruth.txt"})
    text += contents(folder / name);
  const TumSequence read = readTumSequence(folder.string());
  text += numberText(read.fx) + " " + numberText(read.cy) + " " + numberText(read.width) + " " +
          numberText(read.depth_scale);
  fs::remove_all(folder);
  return text;
}

std::string settingsAsText() {
  std::string text;
  for (const WrittenFile& file : writtenFiles()) text += file.text;
  Settings settings;
  applyAssignment("max_range=4.25", &settings);
  applyAssignment("scale_min_pixels=12345", &settings);
  for (const Setting& setting : allSettings()) text += setting.name + setting.range + setting.get(settings);
  text += errorOf([&] { applyAssignment("max_skew=1,5", &settings); });
  text += errorOf([&] { applyAssignment("scale_min_pixels=1.234", &settings); });
  settings.fusion.scale.min_pixels = 12'345'678;
  text += errorOf([&] { validate(settings); });
  settings.association.max_skew = 1.5;
  settings.fusion.scale.min_pixels = 1;
  text += errorOf([&] { validate(settings); });
  return text;
}

std::string refusals() {
  CameraCalibration calibration;
  calibration.width = 1280;
  calibration.height = 1024;
  calibration.K = {-1050.5, 0, 639.5, 0, 1050.5, 511.5, 0, 0, 1};
  VirtualCameraOptions options;
  options.colour.noise = 1234.5;
  return errorOf([&] { validate(calibration); }) +
         errorOf([&] { VirtualCamera(options, std::make_shared<const Scene>()); });
}

TEST(CommaLocale, ChangesNothingThatIsReadOrWritten) {
  const std::function<std::string()> texts[] = {
      [] { return numberText(1234567.5) + numberText(0.1F) + numberText(1234567); },
      [] { return numberText(readNumber("1234.5").value_or(0.0)); },
      [] { return formatNumber(1234567.891, 3) + formatStamp(1'234'567'890'123'456'789); },
      [] { return progressText(1200, 36100, 1234.5); },
      settingsAsText,
      writtenSequence,
      refusals,
  };
  for (std::size_t i = 0; i < std::size(texts); ++i) {
    const std::string expected = texts[i]();
    const CommaLocale locale;
    EXPECT_EQ(texts[i](), expected) << i;
  }
}

TEST(CommaLocale, IsOneForStreamsAndForC) {
  const CommaLocale locale;
  std::ostringstream stream;
  stream << 1234.5;
  EXPECT_EQ(stream.str(), "1.234,5");
  if (!locale.hasC()) GTEST_SKIP() << "no locale of this machine has a comma: C's functions were not tried";
  EXPECT_EQ(std::to_string(0.5), "0,500000");
}

}  // namespace
}  // namespace rgbd_sfm_fusion
