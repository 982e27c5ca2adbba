// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/bag_output.h"

#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

/// rosbag::Bag closes itself in its destructor, which ends the process when the disk is full. A bag that is
/// given up is therefore not destroyed; its file is removed all the same.
void abandon(std::unique_ptr<rosbag::Bag>& bag) {
  static_cast<void>(bag.release());
}

rosbag::CompressionType toRosbag(BagCompression compression) {
  switch (compression) {
    case BagCompression::kLz4:
      return rosbag::compression::LZ4;
    case BagCompression::kBz2:
      return rosbag::compression::BZ2;
    default:
      return rosbag::compression::Uncompressed;
  }
}

}  // namespace

BagCompression bagCompression(const std::string& name) {
  if (name == "none") return BagCompression::kNone;
  if (name == "lz4") return BagCompression::kLz4;
  if (name == "bz2") return BagCompression::kBz2;
  throw std::invalid_argument("compression '" + name + "', expected none, lz4 or bz2");
}

BagOutput::BagOutput(const std::string& path, BagCompression compression)
    : file_(path), bag_(std::make_unique<rosbag::Bag>()) {
  guarded([&] {
    bag_->open(file_.temporaryPath(), rosbag::bagmode::Write);
    bag_->setCompression(toRosbag(compression));
  });
}

BagOutput::~BagOutput() {
  abandon(bag_);
}

void BagOutput::commit() {
  guarded([this] { bag_->close(); });
  bag_.reset();
  file_.commit();
}

void BagOutput::fail(const std::string& reason) {
  abandon(bag_);
  throw std::runtime_error("cannot write " + file_.path() + ": " + reason);
}

}  // namespace rgbd_sfm_fusion
