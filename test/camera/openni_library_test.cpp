// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/openni_library.h"

#include <gtest/gtest.h>

namespace rgbd_sfm_fusion {
namespace {

TEST(OpenNiLibrary, SaysWhichLibraryIsUsedInsteadOfTheOneThatWasAskedFor) {
  const std::string drivers = OpenNiLibrary::driverFolder();
  const std::string folder = drivers.substr(0, drivers.find("/OpenNI2/Drivers"));
  EXPECT_EQ(OpenNiLibrary::whyNotFrom(folder), "");
  const std::string why = OpenNiLibrary::whyNotFrom("/no/such/folder");
  for (const std::string part : {"/no/such/folder", folder.c_str(), "libOpenNI2.so.0", "expected"})
    EXPECT_NE(why.find(part), std::string::npos) << why;
  EXPECT_NE(OpenNiLibrary::whyNotFrom("redist").find("absolute"), std::string::npos);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
