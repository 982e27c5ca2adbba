// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/reconfigure_message.h"

#include <string>

#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

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
    const double value = setting.value(settings);
    switch (setting.kind) {
      case Setting::Kind::kBoolean:
        message.bools.push_back(parameter<dynamic_reconfigure::BoolParameter>(setting.name, value != 0.0));
        break;
      case Setting::Kind::kInteger:
        message.ints.push_back(
            parameter<dynamic_reconfigure::IntParameter>(setting.name, static_cast<int>(value)));
        break;
      case Setting::Kind::kNumber:
        message.doubles.push_back(parameter<dynamic_reconfigure::DoubleParameter>(
            setting.name, readNumber(setting.get(settings)).value()));  // 0.1, not what 0.1F is
        break;
      case Setting::Kind::kChoice:
        message.strs.push_back(
            parameter<dynamic_reconfigure::StrParameter>(setting.name, setting.get(settings)));
        break;
    }
  }
  return message;
}

void applyReconfigureMessage(const dynamic_reconfigure::Config& message, Settings* settings) {
  Settings changed = *settings;
  for (const auto& p : message.bools) findSetting(p.name).setNumber(changed, p.value != 0 ? 1.0 : 0.0);
  for (const auto& p : message.ints) findSetting(p.name).setNumber(changed, p.value);
  for (const auto& p : message.doubles) findSetting(p.name).setNumber(changed, p.value);
  for (const auto& p : message.strs) findSetting(p.name).set(changed, p.value);
  validate(changed);
  *settings = changed;
}

}  // namespace rgbd_sfm_fusion
