// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "parameters.h"

#include <ros/console.h>

#include <algorithm>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

std::string toText(XmlRpc::XmlRpcValue value) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value) ? "on" : "off";
    case XmlRpc::XmlRpcValue::TypeString:
      return static_cast<std::string>(value);
    case XmlRpc::XmlRpcValue::TypeInt:
      return numberText(static_cast<int>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return numberText(static_cast<double>(value));
    default: {
      std::ostringstream text;
      text.imbue(std::locale::classic());
      value.write(text);
      return text.str();
    }
  }
}

void readParameter(const ros::NodeHandle& handle, const Setting& setting, Settings* settings) {
  XmlRpc::XmlRpcValue value;
  if (!handle.getParam(setting.name, value)) return;
  try {
    setting.set(*settings, toText(value));
  } catch (const std::invalid_argument& error) {
    ROS_ERROR_STREAM("parameter " << handle.getNamespace() << "/" << error.what() << "; "
                                  << setting.get(*settings) << " is used");
  }
}

void reportUnknown(const ros::NodeHandle& handle, const std::vector<std::string>& others) {
  const std::string prefix = handle.getNamespace() + "/";
  std::vector<std::string> names;
  if (!handle.getParamNames(names)) return;
  for (const std::string& full_name : names) {
    if (full_name.rfind(prefix, 0) != 0) continue;
    const std::string name = full_name.substr(prefix.size());
    const bool is_nested = name.find('/') != std::string::npos;
    if (is_nested || std::find(others.begin(), others.end(), name) != others.end()) continue;
    try {
      findSetting(name);
    } catch (const std::invalid_argument& error) {
      ROS_WARN_STREAM("parameter " << full_name << " is not used: " << error.what());
    }
  }
}

/// Each node loads the whole file of settings. Parameters that only the other node uses would seem to be this
/// node's, too.
void deleteWhatIsNotOf(SettingScope stage, const ros::NodeHandle& handle) {
  const SettingScope other = stage == SettingScope::kTracker ? SettingScope::kFusion : SettingScope::kTracker;
  for (const Setting& setting : allSettings()) {
    if (setting.scope == other) handle.deleteParam(setting.name);
  }
}

}  // namespace

Settings readParameters(const ros::NodeHandle& private_handle, SettingScope stage,
                        const std::vector<std::string>& others) {
  Settings settings;
  for (const Setting& setting : allSettings()) readParameter(private_handle, setting, &settings);
  reportUnknown(private_handle, others);
  deleteWhatIsNotOf(stage, private_handle);
  try {
    validate(settings);
  } catch (const std::invalid_argument& error) {
    ROS_ERROR_STREAM("parameters of " << private_handle.getNamespace() << ": " << error.what()
                                      << "; all defaults are used");
    return {};
  }
  return settings;
}

}  // namespace rgbd_sfm_fusion
