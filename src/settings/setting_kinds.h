// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Makes rows of the table of settings out of an option's place in Settings.
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/settings/settings.h"

namespace rgbd_sfm_fusion::setting_kinds {

/// The shortest text that reads back as the same number.
std::string toText(double value);
std::string toText(float value);
std::string toText(int value);

/// @throws std::invalid_argument unless all of `text` is a number within the setting's range
double parseNumber(const Setting& setting, const std::string& text);
/// on, off, true, false, yes, no, 1, 0
bool parseBoolean(const Setting& setting, const std::string& text);
/// @return index of the choice
std::size_t parseChoice(const Setting& setting, const std::string& text);

Setting describe(Setting::Kind kind, std::string name, std::string unit, SettingScope scope,
                 std::string description);
Setting describeNumber(Setting::Kind kind, double minimum, double maximum, std::string name, std::string unit,
                       SettingScope scope, std::string description);
Setting describeChoice(std::vector<std::string> choices, std::string name, SettingScope scope,
                       std::string description);

/// @param field  Settings& -> float&, double& or int&
template <class Field, class... Others>
Setting number(std::string name, std::string unit, double minimum, double maximum, SettingScope scope,
               std::string description, Field field, Others... others) {
  using Value = std::remove_reference_t<std::invoke_result_t<Field, Settings&>>;
  const auto kind = std::is_integral_v<Value> ? Setting::Kind::kInteger : Setting::Kind::kNumber;
  Setting setting =
      describeNumber(kind, minimum, maximum, std::move(name), std::move(unit), scope, std::move(description));
  setting.get = [field](const Settings& settings) {
    Settings copy = settings;
    return toText(field(copy));
  };
  setting.set = [field, bare = setting, others...](Settings& settings, const std::string& text) {
    field(settings) = static_cast<Value>(parseNumber(bare, text));
    ((others(settings) = field(settings)), ...);
  };
  return setting;
}

/// @param fields  Settings& -> bool&; several that are one setting to users
template <class... Fields>
Setting boolean(std::string name, SettingScope scope, std::string description, Fields... fields) {
  Setting setting = describe(Setting::Kind::kBoolean, std::move(name), "", scope, std::move(description));
  setting.range = "on or off";
  setting.get = [fields...](const Settings& settings) {
    Settings copy = settings;
    return std::string((fields(copy) && ...) ? "on" : "off");
  };
  setting.set = [bare = setting, fields...](Settings& settings, const std::string& text) {
    const bool value = parseBoolean(bare, text);
    ((fields(settings) = value), ...);
  };
  return setting;
}

/// @param choices  names, in the order of the enumeration's values from 0
/// @param field    Settings& -> the enumeration&
template <class Field>
Setting choice(std::string name, std::vector<std::string> choices, SettingScope scope,
               std::string description, Field field) {
  using Value = std::remove_reference_t<std::invoke_result_t<Field, Settings&>>;
  Setting setting = describeChoice(std::move(choices), std::move(name), scope, std::move(description));
  setting.get = [field, names = setting.choices](const Settings& settings) {
    Settings copy = settings;
    return names.at(static_cast<std::size_t>(field(copy)));
  };
  setting.set = [field, bare = setting](Settings& settings, const std::string& text) {
    field(settings) = static_cast<Value>(parseChoice(bare, text));
  };
  return setting;
}

}  // namespace rgbd_sfm_fusion::setting_kinds
