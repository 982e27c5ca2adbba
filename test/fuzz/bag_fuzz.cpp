// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Reads a bag with all of its messages. Only std::runtime_error may be thrown.
#include <stdexcept>

#include "fuzz_input.h"
#include "rgbd_sfm_fusion/tools/bag_file.h"

using namespace rgbd_sfm_fusion;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  try {
    BagFile bag(folder.write("fuzz.bag", toText(data, size)));
    for (std::size_t i = 0; i < bag.connections().size(); ++i) {
      for (const BagFile::Entry& entry : bag.entries(i)) bag.read(i, entry);
    }
  } catch (const std::runtime_error&) {
  }
  return 0;
}
