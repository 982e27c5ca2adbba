// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Writes the package's files that list settings; for developers, after a change of the table.
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "rgbd_sfm_fusion/settings/written_files.h"

namespace {

namespace fs = std::filesystem;

void writeAll(const fs::path& package) {
  if (!fs::exists(package / "package.xml"))
    throw std::runtime_error(package.string() + " has no package.xml: expected the package's folder");
  for (const rgbd_sfm_fusion::WrittenFile& file : rgbd_sfm_fusion::writtenFiles()) {
    // Files are written in place, so that scripts stay executable.
    std::ofstream stream(package / file.path, std::ios::binary);
    stream << file.text << std::flush;
    if (!stream) throw std::runtime_error("cannot write " + (package / file.path).string());
    std::cout << file.path << '\n';
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_settings PACKAGE_FOLDER\n";
    return 2;
  }
  try {
    writeAll(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "write_settings: " << error.what() << '\n';
    return 1;
  }
}
