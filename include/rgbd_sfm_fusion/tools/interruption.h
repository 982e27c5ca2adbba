// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace rgbd_sfm_fusion {

constexpr int kExitInterrupted = 130;  ///< as a shell has it for Ctrl-C

/// What a tool that is asked to stop throws, so that what it has begun is removed.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

/// From now on Ctrl-C, `kill` and a terminal that closes are noted only, and a file that grows beyond a limit
/// or a pipe that nobody reads is an error of writing, instead of the end of the process.
void catchSignals();

/// @throws Interrupted when the process was asked to stop
void throwIfInterrupted();

}  // namespace rgbd_sfm_fusion
