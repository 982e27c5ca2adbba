// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/pending_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace rgbd_sfm_fusion {
namespace {

namespace fs = std::filesystem;

std::runtime_error cannotWrite(const std::string& path, const std::string& reason) {
  return std::runtime_error("cannot write " + path + ": " + reason);
}

std::string withoutLinks(const std::string& path) {
  constexpr int kMostLinks = 40;  // the kernel's limit
  fs::path target = path;
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(target, error); ++i)
    target = target.parent_path() / fs::read_symlink(target, error);
  return target.string();
}

void requireFileOrNothing(const std::string& path) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  if (type == fs::file_type::directory) throw cannotWrite(path, "it is a folder");
  if (type == fs::file_type::not_found || type == fs::file_type::regular || type == fs::file_type::none)
    return;
  throw cannotWrite(path,
                    "it is a device or a pipe, expected the name of a file, which appears when all is done");
}

/// Says why a temporary file is there already.
std::string reasonOf(const std::string& temporary_path) {
  const int file = open(temporary_path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool is_locked = file >= 0 && flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (file >= 0) close(file);
  if (is_locked) return "it is being written already, as " + temporary_path;
  return temporary_path + " is there, perhaps of a run that was killed: remove it, or choose another name";
}

}  // namespace

PendingFile::PendingFile(const std::string& path) : PendingFile(path, withoutLinks(path) + ".partial") {}

PendingFile::PendingFile(std::string path, std::string temporary_path)
    : path_(std::move(path)), target_(withoutLinks(path_)), temporary_path_(std::move(temporary_path)) {
  requireFileOrNothing(path_);
  lock_ = open(temporary_path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (lock_ < 0 && errno == EEXIST) throw cannotWrite(path_, reasonOf(temporary_path_));
  if (lock_ < 0) throw cannotWrite(path_, std::strerror(errno));
  static_cast<void>(
      flock(lock_, LOCK_EX | LOCK_NB));  // where there are no locks, the message is less precise
}

PendingFile::~PendingFile() {
  if (!committed_) std::remove(temporary_path_.c_str());
  close(lock_);
}

void PendingFile::commit() {
  if (std::rename(temporary_path_.c_str(), target_.c_str()) != 0)
    throw cannotWrite(path_, std::strerror(errno));
  committed_ = true;
}

PendingFolder::PendingFolder(std::string path, Existing existing)
    : path_(std::move(path)), existing_(existing) {
  while (path_.size() > 1 && path_.back() == '/') path_.pop_back();
  std::error_code error;
  const fs::path parent = fs::path(path_).parent_path();
  if (!parent.empty()) fs::create_directories(parent, error);
  if (!error) made_ = fs::create_directory(path_, error);
  if (error) throw std::runtime_error("cannot make folder " + path_ + ": " + error.message());
  if (!made_ && existing == Existing::kRefuse)
    throw cannotWrite(
        path_,
        "it is there already: another run writes it, or was killed; remove it, or choose another name");
}

PendingFolder::~PendingFolder() {
  std::error_code ignored;
  if (made_ && existing_ == Existing::kRefuse) fs::remove_all(path_, ignored);
  if (made_ && existing_ == Existing::kAccept) fs::remove(path_, ignored);
}

void requireNoInput(const std::string& output, const std::vector<std::string>& inputs) {
  const std::string target = withoutLinks(output);
  for (const std::string& input : inputs) {
    for (const std::string& written : {target, target + ".partial"}) {
      std::error_code error;
      if (!fs::equivalent(written, input, error) || error) continue;
      throw cannotWrite(output, "that would destroy the input " + input + ": choose another name");
    }
  }
}

}  // namespace rgbd_sfm_fusion
