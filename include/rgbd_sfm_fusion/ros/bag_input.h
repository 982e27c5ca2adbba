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

#include "rgbd_sfm_fusion/input/camera_calibration.h"
#include "rgbd_sfm_fusion/input/depth_association.h"
#include "rgbd_sfm_fusion/input/topic_choice.h"
#include "rgbd_sfm_fusion/tools/bag_set.h"

namespace rgbd_sfm_fusion {

struct BagSelection {
  std::string colour_topic;       ///< empty, like the next two: the only one that it can be
  std::string camera_info_topic;  ///< of the colour camera
  std::string depth_topic;
  std::string calibration_file;                               ///< used instead of camera_info; empty: none
  double start = 0.0;                                         ///< [s] from the first image on
  double duration = std::numeric_limits<double>::infinity();  ///< [s]
};

/// E.g. `colour /camera/rgb/image_raw, depth /camera/depth/image_raw, calibration /camera/rgb/camera_info`
std::string describe(const BagSelection& selection);

/// Colour images of bags, each with the depth image that belongs to it. Compressed ones are decoded.
class BagInput {
 public:
  using Pair = ColourDepthPair<sensor_msgs::ImageConstPtr, sensor_msgs::ImageConstPtr>;

  /// Called for a message that is left out, as it cannot be read.
  using OnUnreadable =
      std::function<void(const std::string& topic, Stamp recorded, const std::string& reason)>;

  /// @param paths  of the bags, at least one
  /// @throws std::runtime_error saying why a bag cannot be read; or naming the topic that is missing or
  ///         ambiguous, and the topics that are there
  BagInput(const std::vector<std::string>& paths, const BagSelection& selection,
           const AssociationOptions& association, OnUnreadable on_unreadable);

  /// The topics that were found. Topics that have only compressed images end in the transport's name. The
  /// camera_info topic is empty if the calibration is from a file.
  const BagSelection& selection() const { return selection_; }
  /// The topic of the depth camera's camera_info; empty if there is none.
  const std::string& depthCameraInfoTopic() const { return depth_camera_info_topic_; }
  bool isCompressed(const std::string& topic) const;

  /// What was assumed about the calibration, and why. Empty if nothing was.
  const std::string& assumption() const { return assumption_; }

  /// The calibration for all images, from the file or from the first camera_info.
  const CameraCalibration& calibration() const { return calibration_; }
  /// The same for depth, from the topic beside its images. None if there is no usable one.
  const std::optional<CameraCalibration>& depthCalibration() const { return depth_calibration_; }
  /// Whether depth images are registered to the rectified colour image, as their name says.
  bool depthIsRectified() const;
  /// Why the depth camera_info cannot be used; empty if it can, or if there is none.
  const std::string& depthCalibrationProblem() const { return depth_calibration_problem_; }

  /// Number of colour images. next() may give fewer: it leaves out images with unusable stamps.
  std::size_t size() const { return size_; }

  /// What became of the images so far.
  const StreamCounts& colourCounts() const { return associator_.colourCounts(); }
  StreamCounts depthCounts() const { return associator_.depthCounts(); }

  /// @return nothing at the end
  /// @throws std::runtime_error if the bag is damaged there
  std::optional<Pair> next();

 private:
  using Connections = std::vector<std::size_t>;

  /// The topics of that type, in the definition that is known here.
  template <class Message>
  Connections connectionsOf(const std::string& topic) const;
  Connections imagesOf(const std::string& topic) const;
  Connections requireImages(const std::string& topic, const std::vector<const char*>& transports,
                            std::string* found) const;
  /// Says why there is none of the type, if the bag has it in another definition.
  template <class Message>
  void requireSameDefinition(const std::string& topic) const;
  [[noreturn]] void refuseMissing(const std::string& topic, const std::string& type) const;
  void chooseTopics();
  std::vector<ImageTopic> imageTopics();
  ImageTopic describe(const std::string& name, const Connections& connections);
  void findCalibration();
  Connections findCameraInfo(std::string* topic) const;
  std::optional<sensor_msgs::CameraInfo> firstCameraInfo(const Connections& connections);
  sensor_msgs::ImagePtr readImageAt(const BagSet::Place& place);
  void selectPlaces(const Connections& colour, const Connections& depth);
  void take(const BagSet::Place& place);

  BagSelection selection_;
  OnUnreadable on_unreadable_;
  BagSet bags_;
  std::vector<BagSet::Place> places_;
  std::size_t position_ = 0;
  DepthAssociator<sensor_msgs::ImageConstPtr, sensor_msgs::ImageConstPtr> associator_;
  CameraCalibration calibration_;
  std::string assumption_;
  std::string depth_camera_info_topic_;
  std::optional<CameraCalibration> depth_calibration_;
  std::string depth_calibration_problem_;
  std::size_t size_ = 0;
};

}  // namespace rgbd_sfm_fusion
