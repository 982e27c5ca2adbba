// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>

#include <memory>
#include <string>

#include "rgbd_sfm_fusion/tools/pending_file.h"

namespace rgbd_sfm_fusion {

enum class BagCompression { kNone, kLz4, kBz2 };

/// @param name  none, lz4 or bz2
/// @throws std::invalid_argument for any other
BagCompression bagCompression(const std::string& name);

/// A bag that appears under its name only when it is complete. Its bytes depend only on the messages and
/// their order.
class BagOutput {
 public:
  /// @throws std::runtime_error naming the path when it can't be written
  explicit BagOutput(const std::string& path, BagCompression compression = BagCompression::kNone);
  ~BagOutput();

  /// @param message  its header's stamp becomes the message's time in the bag
  /// @throws std::runtime_error, e.g. when the disk is full
  template <class Message>
  void write(const std::string& topic, const Message& message) {
    guarded([&] { bag_->write(topic, message.header.stamp, message); });
  }

  /// Closes the bag and gives it its name.
  /// @throws std::runtime_error as write()
  void commit();

 private:
  template <class Function>
  void guarded(Function function) {
    try {
      function();
    } catch (const rosbag::BagException& error) {
      fail(error.what());
    }
  }
  [[noreturn]] void fail(const std::string& reason);

  PendingFile file_;
  std::unique_ptr<rosbag::Bag> bag_;
};

}  // namespace rgbd_sfm_fusion
