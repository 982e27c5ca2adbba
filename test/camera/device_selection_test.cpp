// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/device_selection.h"

#include <gtest/gtest.h>

#include "rgbd_sfm_fusion/camera/camera_types.h"

namespace rgbd_sfm_fusion {
namespace {

const std::vector<std::string> kUris = {"2bc5/0401@1/2", "2bc5/0401@1/7"};

std::vector<std::string> selected(const std::string& selector, const std::vector<std::string>& uris = kUris) {
  std::vector<std::string> result;
  for (const DeviceCandidate& candidate : selectDevices(selector, uris))
    result.push_back(candidate.uri + (candidate.check_serial ? "?" : ""));
  return result;
}

using Uris = std::vector<std::string>;

TEST(DeviceSelection, TakesIndexUriAndSerial) {
  EXPECT_EQ(selected(""), Uris({kUris[0]}));
  EXPECT_EQ(selected("#1"), Uris({kUris[0]}));
  EXPECT_EQ(selected("#2"), Uris({kUris[1]}));
  EXPECT_EQ(selected(kUris[1]), Uris({kUris[1]}));
  EXPECT_EQ(selected("17081234"), Uris({kUris[0] + "?", kUris[1] + "?", "17081234"}));
}

TEST(DeviceSelection, FindsNothingWhereNothingIsMeant) {
  for (const char* selector : {"#", "#0", "#3", "#x", "#-1", "#99999999999999999999", "# 1"})
    EXPECT_TRUE(selected(selector).empty()) << selector;
  EXPECT_TRUE(selected("", {}).empty());
  EXPECT_TRUE(selected("#1", {}).empty());
}

TEST(StreamMode, IsReadAndWritten) {
  for (const char* text : {"640x480@30", "1280x1024@7", "1x1@1"})
    EXPECT_EQ(toText(parseStreamMode(text)), text);
  for (const char* text : {"", "640x480", "640x480@", "640x480@0", "-640x480@30", "640x480@30 ", "640X480@30",
                           "999999999999x480@30"})
    EXPECT_THROW(parseStreamMode(text), std::invalid_argument) << text;
}

}  // namespace
}  // namespace rgbd_sfm_fusion
