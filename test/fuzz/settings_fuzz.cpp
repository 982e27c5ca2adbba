// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Reads a file of settings, and the same text given to `--set`. Only std::invalid_argument may be thrown.
/// What is accepted has to be accepted again after it was written and read.
#include <cstdlib>
#include <stdexcept>

#include "fuzz_input.h"
#include "rgbd_sfm_fusion/settings/settings.h"

using namespace rgbd_sfm_fusion;

namespace {

void requireReadable(const Settings& settings) {
  Settings again;
  for (const Setting& setting : allSettings()) setting.set(again, setting.get(settings));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  const std::string text = toText(data, size);
  try {
    Settings settings;
    loadSettings({folder.write("settings.yaml", text)}, &settings);
    requireReadable(settings);
    validate(settings);
  } catch (const std::invalid_argument&) {
  }
  try {
    Settings settings;
    applyAssignment(text, &settings);
    requireReadable(settings);
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
