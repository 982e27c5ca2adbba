// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "driver_settings.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "rgbd_sfm_fusion/settings/nearest_name.h"
#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kLongest = 1e6;  // [s] of any time

struct Range {
  double low;
  double high;
};

[[noreturn]] void reject(const std::string& key, const std::string& value, const std::string& expected) {
  throw std::invalid_argument(key + "=" + value + ": expected " + expected);
}

double numberOf(const std::string& key, const std::string& value, Range range) {
  const std::optional<double> number = readNumber(value);
  if (!number || !(*number >= range.low && *number <= range.high))
    reject(key, value, "a number from " + numberText(range.low) + " to " + numberText(range.high));
  return *number;
}

std::vector<std::string> parts(const std::string& text, char separator) {
  std::istringstream stream(text);
  std::vector<std::string> result;
  for (std::string part; std::getline(stream, part, separator);) result.push_back(part);
  return result;
}

bool switchOf(const std::string& key, const std::string& value) {
  if (value != "on" && value != "off") reject(key, value, "on or off");
  return value == "on";
}

std::vector<double> timesOf(const std::string& key, const std::string& value) {
  std::vector<double> times;
  for (const std::string& part : parts(value, ',')) times.push_back(numberOf(key, part, {0.0, kLongest}));
  return times;
}

std::vector<Stall> stallsOf(const std::string& key, const std::string& value) {
  std::vector<Stall> stalls;
  for (const std::string& part : parts(value, ',')) {
    const std::vector<std::string> pair = parts(part, ':');
    if (pair.size() != 2) reject(key, value, "TIME:DURATION,TIME:DURATION,... in seconds");
    stalls.push_back({numberOf(key, pair[0], {0.0, kLongest}), numberOf(key, pair[1], {0.0, kLongest})});
  }
  return stalls;
}

std::uint64_t seedOf(const std::string& key, const std::string& value) {
  return static_cast<std::uint64_t>(numberOf(key, value, {0.0, 4294967295.0}));
}

/// When the device comes and goes, as users write it: three lists.
struct PlugTimes {
  double absent_until = 0.0;
  std::vector<double> unplug;
  std::vector<double> replug;

  std::vector<PlugEvent> events() const {
    std::vector<PlugEvent> events;
    if (absent_until > 0.0) events.push_back({absent_until, true});
    for (const double time : unplug) events.push_back({time, false});
    for (const double time : replug) events.push_back({time, true});
    const auto by_time = [](const PlugEvent& a, const PlugEvent& b) { return a.time < b.time; };
    std::stable_sort(events.begin(), events.end(), by_time);
    bool plugged = absent_until <= 0.0;
    double last = 0.0;
    for (const PlugEvent& event : events) {
      if (event.plugged == plugged || event.time <= last) {
        throw std::invalid_argument(
            "unplug, replug and absent_until: expected times that take turns, as in unplug=5,15 replug=7,17");
      }
      plugged = event.plugged;
      last = event.time;
    }
    return events;
  }
};

/// The next word. Between double quotes, spaces are part of it.
bool readWord(std::istream& words, std::string* word) {
  word->clear();
  bool is_quoted = false;
  words >> std::ws;
  for (char c; words.get(c) && (is_quoted || std::isspace(static_cast<unsigned char>(c)) == 0);) {
    if (c == '"') {
      is_quoted = !is_quoted;
    } else {
      *word += c;
    }
  }
  return !word->empty();
}

using Setter = std::function<void(const std::string& key, const std::string& value)>;

std::map<std::string, Setter> settersFor(DriverSettings& s, PlugTimes& plug) {
  const auto number = [](double& target, Range range, double unit = 1.0) -> Setter {
    return [&target, range, unit](const std::string& key, const std::string& value) {
      target = unit * numberOf(key, value, range);
    };
  };
  const auto text = [](std::string& target) -> Setter {
    return [&target](const std::string&, const std::string& value) { target = value; };
  };
  const auto times = [](std::vector<double>& target) -> Setter {
    return [&target](const std::string& key, const std::string& value) { target = timesOf(key, value); };
  };
  return {
      {"seed", [&s](const auto& key, const auto& value) { s.camera.seed = seedOf(key, value); }},
      {"rate", number(s.camera.rate, {1.0, 120.0})},
      {"noise",
       [&s](const auto& key, const auto& value) {
         s.camera.depth.noise = switchOf(key, value);
         if (!s.camera.depth.noise) s.camera.colour = {false, 0.0, 0.0};
       }},
      {"start", number(s.start, {0.0, kLongest})},
      {"skew", number(s.camera.skew, {-1000.0, 1000.0}, 1e-3)},
      {"depth_camera_offset", number(s.depth_camera_offset, {-200.0, 200.0}, 1e-3)},
      {"serial", text(s.serial)},
      {"absent_until", number(plug.absent_until, {0.0, kLongest})},
      {"unplug", times(plug.unplug)},
      {"replug", times(plug.replug)},
      {"stall", [&s](const auto& key, const auto& value) { s.stalls = stallsOf(key, value); }},
      {"drop", number(s.drop, {0.0, 1.0})},
      {"jitter", number(s.jitter, {0.0, 1000.0}, 1e-3)},
      {"clock_offset", number(s.clock_offset, {0.0, kLongest})},
      {"clock_drift", number(s.clock_drift, {-1e4, 1e4}, 1e-6)},
      {"failing_starts",
       [&s](const auto& key, const auto& value) {
         s.failing_starts = static_cast<int>(numberOf(key, value, {0.0, 1e6}));
       }},
      {"lock", text(s.lock)},
      {"log", text(s.log)},
  };
}

}  // namespace

DriverSettings parseDriverSettings(const std::string& text) {
  DriverSettings settings;
  PlugTimes plug;
  const std::map<std::string, Setter> setters = settersFor(settings, plug);
  std::istringstream words(text);
  for (std::string word; readWord(words, &word);) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) throw std::invalid_argument(word + ": expected key=value");
    const std::string key = word.substr(0, equals);
    const auto setter = setters.find(key);
    if (setter == setters.end()) {
      std::vector<std::string> known;
      for (const auto& entry : setters) known.push_back(entry.first);
      throw std::invalid_argument(key + ": no such key; the most similar one is " + nearestName(key, known));
    }
    setter->second(key, word.substr(equals + 1));
  }
  settings.plug_events = plug.events();
  return settings;
}

}  // namespace rgbd_sfm_fusion
