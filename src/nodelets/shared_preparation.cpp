// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "shared_preparation.h"

#include <boost/weak_ptr.hpp>

#include <algorithm>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/pipeline/frame_preparation.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

/// The last images that were made of messages, while somebody still has the message.
template <class Image>
class LastImages {
 public:
  /// All that an image depends on.
  struct Source {
    sensor_msgs::ImageConstPtr message;
    std::shared_ptr<const Rectifier> rectifier;
    double unit = 0.0, saturated = 0.0;
  };

  template <class Make>
  Image take(const Source& source, Make make) {
    if (const std::optional<Image> made = find(source)) return *made;
    const Image image = make();
    const std::lock_guard<std::mutex> lock(mutex_);
    images_.push_back({source.message, source.rectifier, source.unit, source.saturated, image});
    if (images_.size() > kMost) images_.pop_front();
    return image;
  }

 private:
  // 1.2 MB each. While fusion is further behind than that, it makes them anew.
  static constexpr std::size_t kMost = 6;

  struct Made {
    boost::weak_ptr<const sensor_msgs::Image> message;
    std::shared_ptr<const Rectifier> rectifier;
    double unit, saturated;
    Image image;
  };

  std::optional<Image> find(const Source& source) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto isGone = [](const Made& made) { return made.message.expired(); };
    images_.erase(std::remove_if(images_.begin(), images_.end(), isGone), images_.end());
    for (const Made& made : images_) {
      if (made.message.lock() == source.message && made.rectifier == source.rectifier &&
          made.unit == source.unit && made.saturated == source.saturated)
        return made.image;
    }
    return std::nullopt;
  }

  std::mutex mutex_;
  std::deque<Made> images_;
};

struct KnownRectifier {
  CameraCalibration calibration;
  std::optional<CameraCalibration> depth;
  bool depth_is_rectified;
  std::weak_ptr<const Rectifier> rectifier;
};

RawImage rawImage(const sensor_msgs::ImageConstPtr& message) {
  return toRawImage(message, fromRosTime(message->header.stamp));
}

}  // namespace

std::shared_ptr<const Rectifier> sharedRectifier(const CameraCalibration& calibration,
                                                 const std::optional<CameraCalibration>& depth,
                                                 bool depth_is_rectified) {
  static std::mutex mutex;
  static std::vector<KnownRectifier> known;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto isGone = [](const KnownRectifier& one) { return one.rectifier.expired(); };
  known.erase(std::remove_if(known.begin(), known.end(), isGone), known.end());
  for (const KnownRectifier& one : known) {
    if (!(one.calibration == calibration) || !(one.depth == depth) ||
        one.depth_is_rectified != depth_is_rectified)
      continue;
    if (auto rectifier = one.rectifier.lock()) return rectifier;
  }
  auto rectifier = std::make_shared<const Rectifier>(calibration, depth, depth_is_rectified);
  known.push_back({calibration, depth, depth_is_rectified, rectifier});
  return rectifier;
}

GreyImage sharedGrey(const sensor_msgs::ImageConstPtr& colour,
                     const std::shared_ptr<const Rectifier>& rectifier) {
  static LastImages<GreyImage> images;
  return images.take({colour, rectifier}, [&] { return prepareGrey(*rectifier, rawImage(colour)); });
}

DepthImage sharedDepth(const sensor_msgs::ImageConstPtr& depth,
                       const std::shared_ptr<const Rectifier>& rectifier, double unit, double saturated) {
  static LastImages<DepthImage> images;
  if (!depth) return {};
  return images.take({depth, rectifier, unit, saturated},
                     [&] { return prepareDepth(*rectifier, rawImage(depth), unit, saturated); });
}

}  // namespace rgbd_sfm_fusion
