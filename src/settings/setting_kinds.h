// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Makes rows of the table of settings from an option's place in Settings.
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/settings/settings.h"

namespace rgbd_sfm_fusion::setting_kinds {

Setting describe(Setting::Kind kind, std::string name, std::string unit, SettingScope scope,
                 std::string description);
Setting describeNumber(Setting::Kind kind, double minimum, double maximum, std::string name, std::string unit,
                       SettingScope scope, std::string description);
Setting describeChoice(std::vector<std::string> choices, std::string name, SettingScope scope,
                       std::string description);

/// @param field   Settings& -> float&, double& or int&
/// @param others  more fields that the same setting sets
template <class Field, class... Others>
Setting number(std::string name, std::string unit, double minimum, double maximum, SettingScope scope,
               std::string description, Field field, Others... others) {
  using Value = std::remove_reference_t<std::invoke_result_t<Field, Settings&>>;
  const auto kind = std::is_integral_v<Value> ? Setting::Kind::kInteger : Setting::Kind::kNumber;
  Setting setting =
      describeNumber(kind, minimum, maximum, std::move(name), std::move(unit), scope, std::move(description));
  setting.is_single_precision = std::is_same_v<Value, float>;
  setting.value = [field](const Settings& settings) {
    Settings copy = settings;
    return static_cast<double>(field(copy));
  };
  setting.assign = [field, others...](Settings& settings, double value) {
    field(settings) = static_cast<Value>(value);
    ((others(settings) = field(settings)), ...);
  };
  return setting;
}

/// @param fields  Settings& -> bool&; if several, one setting sets them all
template <class... Fields>
Setting boolean(std::string name, SettingScope scope, std::string description, Fields... fields) {
  Setting setting = describe(Setting::Kind::kBoolean, std::move(name), "", scope, std::move(description));
  setting.range = "on or off";
  setting.maximum = 1.0;
  setting.value = [fields...](const Settings& settings) {
    Settings copy = settings;
    return (fields(copy) && ...) ? 1.0 : 0.0;
  };
  setting.assign = [fields...](Settings& settings, double value) {
    ((fields(settings) = value != 0.0), ...);
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
  setting.value = [field](const Settings& settings) {
    Settings copy = settings;
    return static_cast<double>(field(copy));
  };
  setting.assign = [field](Settings& settings, double value) {
    field(settings) = static_cast<Value>(static_cast<int>(value));
  };
  return setting;
}

}  // namespace rgbd_sfm_fusion::setting_kinds
