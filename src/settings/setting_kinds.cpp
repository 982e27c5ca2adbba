// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "setting_kinds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>
#include <stdexcept>

namespace rgbd_sfm_fusion::setting_kinds {
namespace {

std::invalid_argument outOfRange(const Setting& setting, const std::string& text) {
  const std::string unit = setting.unit.empty() ? "" : " " + setting.unit;
  return std::invalid_argument(setting.name + " = " + text + ": expected " + setting.range + unit);
}

/// Independent of the process's locale, unlike std::stod.
bool readNumber(const std::string& text, double* value) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  return stream >> *value && (stream >> std::ws).eof();
}

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
  int digits = 1;
  for (double power = 10.0; power <= std::abs(number) && digits < 7; power *= 10.0)
    ++digits;  // 100, not 1e+02
  double back = 0.0;
  while (digits < kMostDigits &&
         !(readNumber(format(number, digits), &back) && static_cast<Value>(back) == value)) {
    ++digits;
  }
  return format(number, digits);
}

std::string join(const std::vector<std::string>& words) {
  std::string text = words.front();
  for (std::size_t i = 1; i < words.size(); ++i) text += (i + 1 < words.size() ? ", " : " or ") + words[i];
  return text;
}

}  // namespace

std::string toText(double value) {
  return shortestText(value);
}

std::string toText(float value) {
  return shortestText(value);
}

std::string toText(int value) {
  return std::to_string(value);
}

double parseNumber(const Setting& setting, const std::string& text) {
  double value = 0.0;
  const bool is_number = readNumber(text, &value) && value >= setting.minimum && value <= setting.maximum;
  const bool is_whole = setting.kind != Setting::Kind::kInteger || value == std::floor(value);
  if (!is_number || !is_whole) throw outOfRange(setting, text);
  return value;
}

bool parseBoolean(const Setting& setting, const std::string& text) {
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  for (const char* yes : {"on", "true", "yes", "1"}) {
    if (lower == yes) return true;
  }
  for (const char* no : {"off", "false", "no", "0"}) {
    if (lower == no) return false;
  }
  throw outOfRange(setting, text);
}

std::size_t parseChoice(const Setting& setting, const std::string& text) {
  const auto found = std::find(setting.choices.begin(), setting.choices.end(), text);
  if (found == setting.choices.end()) throw outOfRange(setting, text);
  return static_cast<std::size_t>(found - setting.choices.begin());
}

Setting describe(Setting::Kind kind, std::string name, std::string unit, SettingScope scope,
                 std::string description) {
  Setting setting;
  setting.kind = kind;
  setting.name = std::move(name);
  setting.unit = std::move(unit);
  setting.scope = scope;
  setting.description = std::move(description);
  return setting;
}

Setting describeNumber(Setting::Kind kind, double minimum, double maximum, std::string name, std::string unit,
                       SettingScope scope, std::string description) {
  Setting setting = describe(kind, std::move(name), std::move(unit), scope, std::move(description));
  setting.minimum = minimum;
  setting.maximum = maximum;
  const std::string whole = kind == Setting::Kind::kInteger ? "a whole number, " : "";
  setting.range = whole + toText(minimum) + " to " + toText(maximum);
  return setting;
}

Setting describeChoice(std::vector<std::string> choices, std::string name, SettingScope scope,
                       std::string description) {
  Setting setting = describe(Setting::Kind::kChoice, std::move(name), "", scope, std::move(description));
  setting.choices = std::move(choices);
  setting.range = join(setting.choices);
  return setting;
}

}  // namespace rgbd_sfm_fusion::setting_kinds
