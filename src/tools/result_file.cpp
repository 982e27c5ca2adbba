// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/result_file.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace rgbd_sfm_fusion {

ResultFile::ResultFile(const std::string& path)
    : file_(path), stream_(file_.temporaryPath(), std::ios::binary) {
  check();
}

void ResultFile::write(const std::string& text) {
  errno = 0;
  stream_ << text;
  check();
}

void ResultFile::close() {
  errno = 0;
  stream_.close();
  check();
}

void ResultFile::check() {
  if (stream_) return;
  const std::string reason = errno != 0 ? std::strerror(errno) : "unknown error";
  throw std::runtime_error("cannot write " + file_.path() + ": " + reason);
}

}  // namespace rgbd_sfm_fusion
