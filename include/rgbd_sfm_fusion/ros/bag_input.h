// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/input/depth_association.h"
#include "rgbd_sfm_fusion/tools/bag_file.h"

namespace rgbd_sfm_fusion {

struct BagSelection {
  std::string colour_topic = "/camera/rgb/image_raw";
  std::string camera_info_topic = "/camera/rgb/camera_info";
  std::string depth_topic = "/camera/depth_registered/image_raw";
  double start = 0.0;                                         ///< [s] from the bag's first message on
  double duration = std::numeric_limits<double>::infinity();  ///< [s]
};

/// Colour images of a bag, each with the depth image that belongs to it.
class BagInput {
 public:
  using Pair = ColourDepthPair<sensor_msgs::ImageConstPtr, sensor_msgs::ImageConstPtr>;

  /// Is told of a message that cannot be read, and is therefore left out.
  using OnUnreadable =
      std::function<void(const std::string& topic, Stamp recorded, const std::string& reason)>;

  /// @throws std::runtime_error with the reason why the bag can't be read, or the topic that it lacks with
  ///         those that it has
  BagInput(const std::string& path, const BagSelection& selection, const AssociationOptions& association,
           OnUnreadable on_unreadable);

  /// The first one of its topic, which is valid for all images.
  const sensor_msgs::CameraInfo& cameraInfo() const { return camera_info_; }
  /// The same for depth, from the topic beside its images.
  const std::optional<sensor_msgs::CameraInfo>& depthCameraInfo() const { return depth_camera_info_; }

  /// Number of colour images; next() leaves out those whose stamps are of no use.
  std::size_t size() const { return size_; }

  /// What became of the images so far.
  const StreamCounts& colourCounts() const { return associator_.colourCounts(); }
  StreamCounts depthCounts() const { return associator_.depthCounts(); }

  /// @return nothing at the end
  /// @throws std::runtime_error where the bag is damaged
  std::optional<Pair> next();

 private:
  /// A message, in the order of recording.
  struct Place {
    std::size_t connection;
    BagFile::Entry entry;
  };

  std::vector<std::size_t> connectionsOf(const std::string& topic, const char* type,
                                         const char* md5sum) const;
  std::vector<std::size_t> requireTopic(const std::string& topic, const char* type, const char* md5sum) const;
  std::vector<Place> placesOf(const std::vector<std::size_t>& connections) const;
  std::optional<sensor_msgs::CameraInfo> firstCameraInfo(const std::vector<std::size_t>& connections);
  void take(const Place& place);

  std::string path_;
  BagSelection selection_;
  OnUnreadable on_unreadable_;
  BagFile bag_;
  std::vector<Place> places_;
  std::size_t position_ = 0;
  DepthAssociator<sensor_msgs::ImageConstPtr, sensor_msgs::ImageConstPtr> associator_;
  sensor_msgs::CameraInfo camera_info_;
  std::optional<sensor_msgs::CameraInfo> depth_camera_info_;
  std::size_t size_ = 0;
};

}  // namespace rgbd_sfm_fusion
