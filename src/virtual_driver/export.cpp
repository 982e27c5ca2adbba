// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "virtual_driver.h"

using rgbd_sfm_fusion::VirtualDriver;
ONI_EXPORT_DRIVER(VirtualDriver)
