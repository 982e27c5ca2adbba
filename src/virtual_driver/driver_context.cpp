// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "driver_context.h"

#include <cmath>
#include <memory>

#include "rgbd_sfm_fusion/scene/room.h"

namespace rgbd_sfm_fusion {

DriverContext::DriverContext(const DriverSettings& settings)
    : settings_(settings), log_(settings.log), failing_starts_(settings.failing_starts) {
  VirtualCamera(settings.camera, std::make_shared<const Scene>());  // throws if an option is out of range
  sharedRoom();  // takes seconds; a stream's first frame should not have to wait for it
  loaded_at_ = SteadyClock::now();
}

const Timeline& DriverContext::timeline() {
  std::call_once(begun_, [this] {
    const double rate = settings_.camera.rate;
    timeline_.emplace(SteadyClock::now(), rate,
                      static_cast<std::uint32_t>(std::llround(settings_.start * rate)));
  });
  return *timeline_;
}

}  // namespace rgbd_sfm_fusion
