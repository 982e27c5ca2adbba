// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// Number of letters to insert, delete or replace to turn `a` into `b` (Levenshtein).
std::size_t editDistance(const std::string& a, const std::string& b);

/// The one of `names` that is most like `name`; of several, the first. `names` must not be empty.
const std::string& nearestName(const std::string& name, const std::vector<std::string>& names);

}  // namespace rgbd_sfm_fusion
