// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/pending_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

namespace rgbd_sfm_fusion {
namespace {

std::runtime_error cannotWrite(const std::string& path, const std::string& reason) {
  return std::runtime_error("cannot write " + path + ": " + reason);
}

}  // namespace

PendingFile::PendingFile(const std::string& path) : PendingFile(path, path + ".partial") {}

PendingFile::PendingFile(std::string path, std::string temporary_path)
    : path_(std::move(path)), temporary_path_(std::move(temporary_path)) {
  if (std::filesystem::is_directory(path_)) throw cannotWrite(path_, "it is a folder");
  errno = 0;
  if (!std::ofstream(temporary_path_, std::ios::binary | std::ios::trunc)) {
    throw cannotWrite(path_, errno != 0 ? std::strerror(errno) : "unknown error");
  }
}

PendingFile::~PendingFile() {
  if (!committed_) std::remove(temporary_path_.c_str());
}

void PendingFile::commit() {
  if (std::rename(temporary_path_.c_str(), path_.c_str()) != 0)
    throw cannotWrite(path_, std::strerror(errno));
  committed_ = true;
}

}  // namespace rgbd_sfm_fusion
