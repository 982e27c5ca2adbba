// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "setting_kinds.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

std::invalid_argument outOfRange(const Setting& setting, const std::string& text) {
  const std::string unit = setting.unit.empty() ? "" : " " + setting.unit;
  return std::invalid_argument(setting.name + " = " + text + ": expected " + setting.range + unit);
}

/// NaN if the text is neither yes nor no.
double parseBoolean(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  for (const char* yes : {"on", "true", "yes", "1"}) {
    if (text == yes) return 1.0;
  }
  for (const char* no : {"off", "false", "no", "0"}) {
    if (text == no) return 0.0;
  }
  return std::nan("");
}

/// NaN if there is no such choice.
double parseChoice(const std::vector<std::string>& choices, const std::string& text) {
  const auto found = std::find(choices.begin(), choices.end(), text);
  return found == choices.end() ? std::nan("") : static_cast<double>(found - choices.begin());
}

std::string join(const std::vector<std::string>& words) {
  std::string text = words.front();
  for (std::size_t i = 1; i < words.size(); ++i) text += (i + 1 < words.size() ? ", " : " or ") + words[i];
  return text;
}

}  // namespace

std::string Setting::textOf(double number) const {
  switch (kind) {
    case Kind::kBoolean:
      return number != 0.0 ? "on" : "off";
    case Kind::kChoice:
      return choices.at(static_cast<std::size_t>(number));
    default:
      return is_single_precision ? numberText(static_cast<float>(number)) : numberText(number);
  }
}

std::string Setting::get(const Settings& settings) const {
  return textOf(value(settings));
}

bool Setting::accepts(double number) const {
  const bool is_whole = kind == Kind::kNumber || number == std::floor(number);
  return number >= minimum && number <= maximum && is_whole;
}

void Setting::set(Settings& settings, const std::string& text) const {
  double number = 0.0;
  if (kind == Kind::kBoolean) {
    number = parseBoolean(text);
  } else if (kind == Kind::kChoice) {
    number = parseChoice(choices, text);
  } else {
    number = readNumber(text).value_or(std::nan(""));
  }
  if (!accepts(number)) throw outOfRange(*this, text);
  assign(settings, number);
}

void Setting::setNumber(Settings& settings, double number) const {
  if (kind == Kind::kChoice || !accepts(number)) throw outOfRange(*this, numberText(number));
  assign(settings, number);
}

namespace setting_kinds {

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
  setting.range = whole + numberText(minimum) + " to " + numberText(maximum);
  return setting;
}

Setting describeChoice(std::vector<std::string> choices, std::string name, SettingScope scope,
                       std::string description) {
  Setting setting = describe(Setting::Kind::kChoice, std::move(name), "", scope, std::move(description));
  setting.range = join(choices);
  setting.maximum = static_cast<double>(choices.size() - 1);
  setting.choices = std::move(choices);
  return setting;
}

}  // namespace setting_kinds
}  // namespace rgbd_sfm_fusion
