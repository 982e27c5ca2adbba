// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/number_text.h"

#include <cmath>
#include <limits>
#include <locale>

namespace rgbd_sfm_fusion {
namespace {

std::string format(double value, int digits) {
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(digits);
  stream << value;
  return stream.str();
}

template <class Value>
std::string shortestText(Value value) {
  const double number = static_cast<double>(value);
  constexpr int kMostDigits = std::numeric_limits<Value>::max_digits10;
  const auto readsBack = [&](int digits) {
    const std::optional<double> back = readNumber(format(number, digits));
    return back && static_cast<Value>(*back) == value;
  };
  int digits = 1;
  for (double power = 10.0; power <= std::abs(number) && digits < 7; power *= 10.0)
    ++digits;  // 100, not 1e+02
  while (digits < kMostDigits && !readsBack(digits)) ++digits;
  return format(number, digits);
}

}  // namespace

std::string numberText(double value) {
  return shortestText(value);
}

std::string numberText(float value) {
  return shortestText(value);
}

std::string numberText(int value) {
  return std::to_string(value);
}

std::optional<double> readNumber(const std::string& text) {
  std::istringstream stream = plainStream(text);
  double value = 0.0;
  if (!(stream >> value) || !(stream >> std::ws).eof()) return std::nullopt;
  return value;
}

std::istringstream plainStream(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  return stream;
}

}  // namespace rgbd_sfm_fusion
