// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Numbers as text with a decimal point and no grouping, whatever the process's locale: a library does not
/// know what the program around it has set, and files must read the same everywhere.
#pragma once

#include <optional>
#include <sstream>
#include <string>

namespace rgbd_sfm_fusion {

/// The shortest text that reads back as the same number; `nan` or `inf` for those two.
std::string numberText(double value);
std::string numberText(float value);
std::string numberText(int value);

/// @return nothing unless `text` is a finite number and nothing else; spaces may be around it
std::optional<double> readNumber(const std::string& text);

/// A stream from which the words and numbers of `text` can be read.
std::istringstream plainStream(const std::string& text);

}  // namespace rgbd_sfm_fusion
