// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace rgbd_sfm_fusion {

constexpr int kExitInterrupted = 130;  ///< a shell's exit status for Ctrl-C

/// Thrown by a tool that is asked to stop, so that it removes what it has begun to write.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

/// From now on Ctrl-C, `kill` and a closing terminal are only noted. A file that grows beyond a limit, or a
/// pipe that nobody reads, becomes a write error instead of ending the process.
void catchSignals();

/// @throws Interrupted when the process was asked to stop
void throwIfInterrupted();

}  // namespace rgbd_sfm_fusion
