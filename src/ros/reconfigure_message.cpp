// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/reconfigure_message.h"

#include <sstream>
#include <string>

namespace rgbd_sfm_fusion {
namespace {

std::string toText(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

template <class Parameter, class Value>
Parameter parameter(const std::string& name, Value value) {
  Parameter parameter;
  parameter.name = name;
  parameter.value = value;
  return parameter;
}

}  // namespace

dynamic_reconfigure::Config toReconfigureMessage(const Settings& settings, SettingScope stage) {
  dynamic_reconfigure::Config message;
  for (const Setting& setting : allSettings()) {
    if (!setting.isTunableBy(stage)) continue;
    const std::string value = setting.get(settings);
    switch (setting.kind) {
      case Setting::Kind::kBoolean:
        message.bools.push_back(parameter<dynamic_reconfigure::BoolParameter>(setting.name, value == "on"));
        break;
      case Setting::Kind::kInteger:
        message.ints.push_back(parameter<dynamic_reconfigure::IntParameter>(setting.name, std::stoi(value)));
        break;
      case Setting::Kind::kNumber:
        message.doubles.push_back(
            parameter<dynamic_reconfigure::DoubleParameter>(setting.name, std::stod(value)));
        break;
      case Setting::Kind::kChoice:
        message.strs.push_back(parameter<dynamic_reconfigure::StrParameter>(setting.name, value));
        break;
    }
  }
  return message;
}

void applyReconfigureMessage(const dynamic_reconfigure::Config& message, Settings* settings) {
  Settings changed = *settings;
  const auto apply = [&](const std::string& name, const std::string& value) {
    findSetting(name).set(changed, value);
  };
  for (const auto& p : message.bools) apply(p.name, p.value ? "on" : "off");
  for (const auto& p : message.ints) apply(p.name, std::to_string(p.value));
  for (const auto& p : message.doubles) apply(p.name, toText(p.value));
  for (const auto& p : message.strs) apply(p.name, p.value);
  validate(changed);
  *settings = changed;
}

}  // namespace rgbd_sfm_fusion
