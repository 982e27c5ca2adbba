// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// Letters to insert, delete or replace to make `b` of `a` (Levenshtein).
std::size_t editDistance(const std::string& a, const std::string& b);

/// Of `names`, which must not be empty, the one most like `name`; of several, the first.
const std::string& nearestName(const std::string& name, const std::vector<std::string>& names);

}  // namespace rgbd_sfm_fusion
