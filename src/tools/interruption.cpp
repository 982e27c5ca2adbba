// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/interruption.h"

#include <csignal>

namespace rgbd_sfm_fusion {
namespace {

volatile std::sig_atomic_t interrupted = 0;  // a signal handler may touch nothing else

void note(int) {
  interrupted = 1;
}

}  // namespace

void catchSignals() {
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  if (std::signal(SIGHUP, note) == SIG_IGN)
    std::signal(SIGHUP, SIG_IGN);  // nohup ignores it, and that is to stay so
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

void throwIfInterrupted() {
  if (interrupted != 0) throw Interrupted();
}

}  // namespace rgbd_sfm_fusion
