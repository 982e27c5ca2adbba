// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Config.h>

#include "rgbd_sfm_fusion/settings/settings.h"

namespace rgbd_sfm_fusion {

/// The settings that can be tuned at run time by `stage`, as dynamic reconfigure has them.
dynamic_reconfigure::Config toReconfigureMessage(const Settings& settings, SettingScope stage);

/// Applies every value of the message.
/// @throws std::invalid_argument naming what can't be used; then nothing has changed
void applyReconfigureMessage(const dynamic_reconfigure::Config& message, Settings* settings);

}  // namespace rgbd_sfm_fusion
