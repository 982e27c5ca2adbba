// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// OpenNI2's driver interface. It is made for drivers within OpenNI2's own tree, whose macros it expects.
#pragma once

#ifndef XN_NEW
#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
#endif

#include <Driver/OniDriverAPI.h>
