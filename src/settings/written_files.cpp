// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/settings/written_files.h"

#include "rgbd_sfm_fusion/settings/settings.h"
#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

using Kind = Setting::Kind;

/// The preset sets these: a file that named them, too, would undo it.
bool isSetByPreset(const Setting& setting) {
  Settings before;
  for (float DepthNoiseModel::*member :
       {&DepthNoiseModel::quadratic, &DepthNoiseModel::floor, &DepthNoiseModel::lateral_sigma,
        &DepthNoiseModel::common_scale_sigma, &DepthNoiseModel::common_offset_sigma,
        &DepthNoiseModel::min_range, &DepthNoiseModel::max_range, &DepthNoiseModel::far_bias_sigma,
        &DepthNoiseModel::saturated_depth}) {
    before.fusion.noise.*member = -1.0F;
  }
  Settings after = before;
  findSetting("sensor").set(after, "kinect");
  return setting.value(after) != setting.value(before);
}

std::string unitPrefix(const Setting& setting) {
  return setting.unit.empty() ? "" : "[" + setting.unit + "] ";
}

/// Calls `begin(name of a section)` before the settings of each, and `add(setting)`.
template <class Begin, class Add>
void forEachSection(const Begin& begin, const Add& add) {
  std::string section;
  for (const Setting& setting : allSettings()) {
    if (setting.section != section) begin(section = setting.section);
    add(setting);
  }
}

// --- Dynamic reconfigure -------------------------------------------------------------------------------

/// A string in Python.
std::string quoted(const std::string& text) {
  const char quote = text.find('\'') == std::string::npos ? '\'' : '"';
  return quote + text + quote;
}

std::string pythonType(Kind kind) {
  switch (kind) {
    case Kind::kBoolean:
      return "bool_t";
    case Kind::kInteger:
      return "int_t";
    case Kind::kChoice:
      return "str_t";
    default:
      return "double_t";
  }
}

std::string reconfigureLine(const Setting& setting) {
  const std::string description = quoted(unitPrefix(setting) + setting.description);
  const double initial = setting.value(Settings());
  if (setting.kind == Kind::kChoice) {
    std::string choices;
    for (const std::string& choice : setting.choices)
      choices += (choices.empty() ? "" : ", ") + quoted(choice);
    return "choice(" + quoted(setting.name) + ", " + quoted(setting.textOf(initial)) + ", [" + choices +
           "],\n       " + description + ")\n";
  }
  std::string values = initial != 0.0 ? "True" : "False";
  if (setting.kind != Kind::kBoolean) {
    values =
        setting.textOf(initial) + ", " + numberText(setting.minimum) + ", " + numberText(setting.maximum);
  }
  return "gen.add(" + quoted(setting.name) + ", " + pythonType(setting.kind) + ", 0,\n        " +
         description + ", " + values + ")\n";
}

constexpr char kReconfigureHead[] = R"(#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""What can be set at run time. Written by write_settings from src/settings/table.cpp: change it there."""
from dynamic_reconfigure.parameter_generator_catkin import ParameterGenerator)";

constexpr char kChoiceFunction[] = R"(

def choice(name, default, values, description):
    constants = [gen.const(name + '_' + value, str_t, value, '') for value in values]
    gen.add(name, str_t, 0, description, default, edit_method=gen.enum(constants, name))


)";

/// @param node   whose parameters they are
/// @param group  `Tracker` for cfg/Tracker.cfg
WrittenFile reconfigureFile(const std::string& node, const std::string& group, SettingScope stage) {
  std::string lines, types;
  bool has_choices = false;
  for (const Setting& setting : allSettings()) {
    if (!setting.isTunableBy(stage)) continue;
    lines += reconfigureLine(setting);
    if (types.find(pythonType(setting.kind)) == std::string::npos) types += ", " + pythonType(setting.kind);
    has_choices = has_choices || setting.kind == Kind::kChoice;
  }
  return {"cfg/" + group + ".cfg", kReconfigureHead + types + "\n\ngen = ParameterGenerator()\n" +
                                       (has_choices ? kChoiceFunction : "") + lines +
                                       "\nexit(gen.generate('rgbd_sfm_fusion', " + quoted(node) + ", " +
                                       quoted(group) + "))\n"};
}

// --- config/default.yaml -------------------------------------------------------------------------------

std::string yamlLine(const Setting& setting) {
  constexpr std::size_t kColumn = 28;  // of the comments
  std::string line = setting.name + ": " + setting.get(Settings());
  line +=
      std::string(line.size() + 2 < kColumn ? kColumn - line.size() : 2, ' ') + "# " + unitPrefix(setting);
  if (setting.kind == Kind::kChoice) line += setting.range + ": ";
  return line + setting.description + "\n";
}

constexpr char kDefaultHead[] =
    R"(# The best we have, for fuse_bag (--config), the nodelets (rosparam) and launch files. These are the
# values that hold without any file; `fuse_bag --set` and launch arguments come after them.
# Written by write_settings from src/settings/table.cpp: change it there.
#
# Not named here, so that the preset `sensor` can set them:
# )";

WrittenFile defaultFile() {
  std::string lines, of_preset;
  forEachSection([&](const std::string& section) { lines += "\n# " + section + "\n"; },
                 [&](const Setting& setting) {
                   if (isSetByPreset(setting)) {
                     of_preset += (of_preset.empty() ? "" : ", ") + setting.name;
                   } else {
                     lines += yamlLine(setting);
                   }
                 });
  return {"config/default.yaml", kDefaultHead + of_preset + ".\n" + lines};
}

// --- docs/settings.md ----------------------------------------------------------------------------------

std::string atRunTime(SettingScope scope) {
  switch (scope) {
    case SettingScope::kAtStart:
      return "no";
    case SettingScope::kTracker:
      return "tracker";
    case SettingScope::kFusion:
      return "fusion";
    default:
      return "tracker, fusion";
  }
}

std::string presetTable() {
  const Setting& preset = findSetting("sensor");
  std::string table = "\n### What the presets of `sensor` set\n\n|", rule = "|---|";
  for (const std::string& choice : preset.choices) {
    table += " | " + choice;
    rule += "---|";
  }
  table += " |\n" + rule + "\n";
  for (const Setting& setting : allSettings()) {
    if (!isSetByPreset(setting)) continue;
    table += "| `" + setting.name + "` |";
    for (const std::string& choice : preset.choices) {
      Settings settings;
      preset.set(settings, choice);
      table += " " + setting.get(settings) + " |";
    }
    table += "\n";
  }
  return table;
}

constexpr char kDocumentationHead[] = R"(# Settings

All that can be set, by the same names everywhere: in YAML files (`fuse_bag --config`, `config:=` of the
launch files), by `fuse_bag --set name=value`, as private parameters of the tracker and fusion nodelets,
and at run time by dynamic_reconfigure of the node in the column "at run time" ("no": only at the start).
A value that is out of its range is refused with a message that names it, and the one before stays.
`config/paper.yaml` has the paper's method. What the camera's nodelet has is in [astra.md](astra.md).

This page is written by `write_settings` from `src/settings/table.cpp`: change it there.
)";

WrittenFile documentation() {
  std::string text = kDocumentationHead;
  const std::string presets = presetTable();
  std::string before_next;
  forEachSection(
      [&](const std::string& section) {
        text += before_next + "\n## " + section +
                "\n\n| name | unit | range | default | at run time | meaning |\n|---|---|---|---|---|---|\n";
        before_next = section == findSetting("sensor").section ? presets : "";
      },
      [&](const Setting& setting) {
        text += "| `" + setting.name + "` | " + setting.unit + " | " + setting.range + " | " +
                setting.get(Settings()) + " | " + atRunTime(setting.scope) + " | " + setting.description +
                " |\n";
      });
  return {"docs/settings.md", text};
}

}  // namespace

std::vector<WrittenFile> writtenFiles() {
  return {reconfigureFile("tracker", "Tracker", SettingScope::kTracker),
          reconfigureFile("fusion", "Fusion", SettingScope::kFusion), defaultFile(), documentation()};
}

}  // namespace rgbd_sfm_fusion
