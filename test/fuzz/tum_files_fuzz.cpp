// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Reads calib.txt and associations.txt of a sequence, joined by a line of dashes. Only std::runtime_error
/// may be thrown.
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "fuzz_input.h"
#include "rgbd_sfm_fusion/tools/tum_sequence.h"

using namespace rgbd_sfm_fusion;

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  const std::string text = toText(data, size), separator = "\n---\n";
  const std::size_t split = text.find(separator);
  folder.write("calib.txt", text.substr(0, split));
  folder.write("associations.txt", split == std::string::npos ? "" : text.substr(split + separator.size()));
  try {
    const TumSequence sequence = readTumSequence(folder.path());
    require(!sequence.pairs.empty() && sequence.width > 0 && sequence.height > 0);
    require(std::isfinite(sequence.fx) && sequence.fx > 0.0 && sequence.depth_scale > 0.0);
    for (const TumSequence::Pair& pair : sequence.pairs)
      require(pair.rgb_stamp >= 0 && pair.depth_stamp >= 0);
  } catch (const std::runtime_error&) {
  }
  return 0;
}
