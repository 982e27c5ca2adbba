// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "tf_listener.h"

#include <utility>

#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kQueueSize = 100;

}  // namespace

TfListener::TfListener(const ros::NodeHandle& handle, CallbackGuard* guard, tf2::BufferCore* buffer,
                       Observer observer)
    : guard_(guard), buffer_(buffer), observer_(std::move(observer)) {
  ros::NodeHandle copy(handle);
  const auto receiver = [this](const char* topic, bool is_static) -> boost::function<void(const Event&)> {
    return [this, topic, is_static](const Event& event) {
      guard_->run(topic, [&] { receive(event, is_static); });
    };
  };
  moving_ = copy.subscribe<tf2_msgs::TFMessage>("/tf", kQueueSize, receiver("/tf", false));
  static_ = copy.subscribe<tf2_msgs::TFMessage>("/tf_static", kQueueSize, receiver("/tf_static", true));
}

void TfListener::receive(const Event& event, bool is_static) {
  const ros::Time now = ros::Time::now();
  if (now < last_) buffer_->clear();  // keeps what is static
  last_ = now;
  const std::string publisher = event.getPublisherName();
  for (const geometry_msgs::TransformStamped& transform : event.getConstMessage()->transforms) {
    if (!isUsable(transform.header.stamp)) {
      guard_->report(is_static ? "/tf_static" : "/tf",
                     "a transform of " + transform.child_frame_id + " by " + publisher +
                         " has a stamp that is not used: " + describeUsableStamps());
      continue;
    }
    buffer_->setTransform(transform, publisher, is_static);
    observer_(transform, publisher);
  }
}

}  // namespace rgbd_sfm_fusion
