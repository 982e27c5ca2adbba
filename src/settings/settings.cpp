// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/settings/settings.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <stdexcept>

#include "rgbd_sfm_fusion/option_check.h"
#include "rgbd_sfm_fusion/settings/nearest_name.h"

namespace rgbd_sfm_fusion {
namespace {

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string place(const std::string& path, const YAML::Mark& mark) {
  return mark.line < 0 ? path : path + ", line " + std::to_string(mark.line + 1);
}

YAML::Node readYaml(const std::string& path) {
  try {
    return YAML::LoadFile(path);
  } catch (const YAML::BadFile&) {
    throw std::invalid_argument("cannot read " + path);
  } catch (const YAML::ParserException& error) {
    throw std::invalid_argument(place(path, error.mark) + ": " + error.msg);
  }
}

/// A line of a file, with its row of the table.
struct Entry {
  const Setting* setting;
  std::string value;
  std::string place;  ///< file and line
};

std::vector<Entry> readEntries(const std::string& path) {
  const YAML::Node root = readYaml(path);
  if (!root.IsMap() && !root.IsNull()) throw std::invalid_argument(path + ": expected lines 'name: value'");
  std::vector<Entry> entries;
  for (const auto& pair : root) {
    const std::string where = place(path, pair.first.Mark());
    try {
      if (!pair.second.IsScalar()) throw std::invalid_argument("expected 'name: value'");
      entries.push_back({&findSetting(pair.first.Scalar()), pair.second.Scalar(), where});
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(where + ": " + error.what());
    }
  }
  return entries;
}

}  // namespace

const Setting& findSetting(const std::string& name) {
  std::vector<std::string> names;
  for (const Setting& setting : allSettings()) {
    if (setting.name == name) return setting;
    names.push_back(setting.name);
  }
  const std::string nearest = nearestName(name, names);
  std::sort(names.begin(), names.end());
  throw std::invalid_argument("there is no setting '" + name + "'; did you mean '" + nearest +
                              "'? All settings: " + join(names));
}

void loadSettings(const std::vector<std::string>& paths, Settings* settings) {
  std::vector<Entry> entries;
  for (const std::string& path : paths) {
    const std::vector<Entry> more = readEntries(path);
    entries.insert(entries.end(), more.begin(), more.end());
  }
  // The table has presets first. Applied first, they undo nothing that a file says, even if it says so
  // earlier.
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.setting < b.setting; });
  Settings changed = *settings;
  for (const Entry& entry : entries) {
    try {
      entry.setting->set(changed, entry.value);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(entry.place + ": " + error.what());
    }
  }
  *settings = changed;
}

void applyAssignment(const std::string& assignment, Settings* settings) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) throw std::invalid_argument("'" + assignment + "': expected key=value");
  findSetting(assignment.substr(0, equals)).set(*settings, assignment.substr(equals + 1));
}

void validate(const RunOptions& options) {
  requireInRange("depth_scale", options.depth_scale, 1e-6, 1.0);
  requireInRange("keyframe_rate", options.keyframe_rate, 0.1, 100.0);
  requireInRange("queue_size", options.queue_size, 1, 100);
  requireInRange("threads", options.threads, 1, 3);
  requireInRange("points_decimation", options.points_decimation, 1, 16);
}

void validate(const Settings& settings) {
  validate(settings.odometry);
  validate(settings.fusion);
  validate(settings.association);
  validate(settings.run);
}

}  // namespace rgbd_sfm_fusion
