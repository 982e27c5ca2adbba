// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/settings/written_files.h"

#include "rgbd_sfm_fusion/settings/settings.h"
#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

using Kind = Setting::Kind;

std::string unitPrefix(const Setting& setting) {
  return setting.unit.empty() ? "" : "[" + setting.unit + "] ";
}

/// Calls `begin(name of the section)` at the start of each section, and `add(setting)` for each setting.
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

/// @param node   the node that has the parameters
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

// --- config/default.yaml, config/expert.yaml -----------------------------------------------------------

std::string yamlLine(const Setting& setting) {
  constexpr std::size_t kColumn = 28;  // of the comments
  std::string line = setting.name + ": " + setting.get(Settings());
  line +=
      std::string(line.size() + 2 < kColumn ? kColumn - line.size() : 2, ' ') + "# " + unitPrefix(setting);
  if (setting.kind == Kind::kChoice) line += setting.range + ": ";
  return line + setting.description + "\n";
}

constexpr char kDefaultHead[] =
    R"(# What users change. The rest is in expert.yaml. The values hold without any file, too, and are the best
# that we know.
#
# Copy this file, change the copy, and name it: `fuse_bag --config FILE`, or `config:=FILE` of a launch file.
# A file need not name all settings. What it does not name is as it is here and in expert.yaml. `fuse_bag --set`
# and launch arguments come after files.
#
# `sensor` sets range and noise. Name these, too, where yours differ:)";

constexpr char kExpertHead[] =
    R"(# Settings that few users need to change. What most change is in default.yaml. The values hold without any
# file, too, and are the best that we know.
#
# Copy this file, change the copy, and name it beside one of the other kind, or alone:
# `fuse_bag --config FILE --config FILE`; `config:=FILE expert_config:=FILE` of a launch file.
#
# Not named here, as `sensor` in default.yaml sets them:)";

constexpr char kWrittenBy[] =
    "# Written by write_settings from src/settings/table.cpp: change it there.\n#\n";

WrittenFile configFile(const std::string& path, const std::string& head, bool is_everyday) {
  std::string lines, heading, of_preset;
  forEachSection([&](const std::string& section) { heading = "\n# " + section + "\n"; },
                 [&](const Setting& setting) {
                   if (setting.is_set_by_preset) {
                     of_preset += (of_preset.empty() ? "\n# " : ", ") + setting.name;
                   } else if (setting.is_everyday == is_everyday) {
                     lines += heading + yamlLine(setting);
                     heading.clear();
                   }
                 });
  return {path, kWrittenBy + head + of_preset + ".\n" + lines};
}

// --- docs/settings.md ----------------------------------------------------------------------------------

std::string fileOf(const Setting& setting) {
  if (setting.is_set_by_preset) return "–";
  return setting.is_everyday ? "default" : "expert";
}

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
    if (!setting.is_set_by_preset) continue;
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

All that can be set, by the same names everywhere:

- in YAML files: `fuse_bag --config FILE`, any number of times; `config:=FILE` and `expert_config:=FILE` of the launch files;
- by `fuse_bag --set name=value`;
- as private parameters of the tracker and fusion nodelets;
- at run time, by dynamic_reconfigure of the node in the column "at run time" ("no": only at the start).

Three files in `config` are ready to be named or copied. `default.yaml` has what users change, `expert.yaml` the rest; both
have the values that hold without any file. `paper.yaml` has the paper's method. The column "file" says where a setting is;
what the preset `sensor` sets is in neither, so that the preset holds.

Files are read as if they were one: the later value counts, and a preset never undoes what a file says. A value out of its
range is refused with a message that names it, and the one before stays. The settings of the camera's nodelet are in
[astra.md](astra.md).

This page is written by `write_settings` from `src/settings/table.cpp`: change it there.
)";

WrittenFile documentation() {
  std::string text = kDocumentationHead;
  const std::string presets = presetTable();
  std::string before_next;
  forEachSection(
      [&](const std::string& section) {
        text += before_next + "\n## " + section +
                "\n\n| name | unit | range | default | file | at run time | meaning "
                "|\n|---|---|---|---|---|---|---|\n";
        before_next = section == findSetting("sensor").section ? presets : "";
      },
      [&](const Setting& setting) {
        text += "| `" + setting.name + "` | " + setting.unit + " | " + setting.range + " | " +
                setting.get(Settings()) + " | " + fileOf(setting) + " | " + atRunTime(setting.scope) + " | " +
                setting.description + " |\n";
      });
  return {"docs/settings.md", text};
}

}  // namespace

std::vector<WrittenFile> writtenFiles() {
  return {reconfigureFile("tracker", "Tracker", SettingScope::kTracker),
          reconfigureFile("fusion", "Fusion", SettingScope::kFusion),
          configFile("config/default.yaml", kDefaultHead, true),
          configFile("config/expert.yaml", kExpertHead, false), documentation()};
}

}  // namespace rgbd_sfm_fusion
