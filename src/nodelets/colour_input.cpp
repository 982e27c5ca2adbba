// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "colour_input.h"

#include <algorithm>
#include <utility>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kQueueSize = 30;
constexpr std::size_t kMostImages = 120;  // two seconds of a fast camera: as long as tracking may take

}  // namespace

void forgetBefore(const ros::Time& stamp, std::size_t kept, std::deque<sensor_msgs::ImageConstPtr>* images) {
  const auto found = std::find_if(images->rbegin(), images->rend(),
                                  [&](const auto& image) { return image->header.stamp == stamp; });
  if (found != images->rend()) images->erase(images->begin(), found.base() - 1);
  while (images->size() > kept && images->front()->header.stamp < stamp) images->pop_front();
}

void ColourBuffer::push(const sensor_msgs::ImageConstPtr& image) {
  images_.push_back(image);
  if (images_.size() > kMostImages) images_.pop_front();
}

sensor_msgs::ImageConstPtr ColourBuffer::find(const ros::Time& stamp) const {
  const auto found = std::find_if(images_.begin(), images_.end(),
                                  [&](const auto& image) { return image->header.stamp == stamp; });
  return found == images_.end() ? nullptr : *found;
}

bool ColourBuffer::mayCome(const ros::Time& stamp) const {
  return images_.empty() || images_.back()->header.stamp < stamp;
}

ColourInput::ColourInput(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                         CallbackGuard* guard, ImageSubscription::OnImage on_image)
    : handle_(handle),
      private_handle_(private_handle),
      guard_(guard),
      topic_(handle.resolveName("rgb/image_raw")),
      on_image_(std::move(on_image)) {}

void ColourInput::setWanted(bool wanted) {
  if (!wanted) {
    subscription_.reset();
  } else if (!subscription_) {
    subscription_.emplace().subscribe(handle_, private_handle_, "rgb_transport", topic_, kQueueSize, guard_,
                                      on_image_);
  }
}

}  // namespace rgbd_sfm_fusion
