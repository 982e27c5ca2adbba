// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "picture_transport.h"

#include <vector>

namespace rgbd_sfm_fusion {

image_transport::Publisher advertisePicture(const ros::NodeHandle& private_handle, const std::string& name,
                                            std::uint32_t queue_size, const std::function<void()>& changed) {
  const std::string parameter = name + "/disable_pub_plugins";
  if (!private_handle.hasParam(parameter))
    private_handle.setParam(parameter, std::vector<std::string>{"image_transport/compressedDepth"});
  const image_transport::SubscriberStatusCallback callback =
      [changed](const image_transport::SingleSubscriberPublisher&) { changed(); };
  return image_transport::ImageTransport(private_handle).advertise(name, queue_size, callback, callback);
}

}  // namespace rgbd_sfm_fusion
