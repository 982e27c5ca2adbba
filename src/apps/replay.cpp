// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// replay BAG … [ARGUMENT:=VALUE …]: plays bags through tracker and fusion. Finds topics as fuse_bag does,
/// and starts replay.launch with them.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/ros/bag_input.h"
#include "rgbd_sfm_fusion/tools/bag_set.h"
#include "rgbd_sfm_fusion/tools/number_text.h"
#include "rgbd_sfm_fusion/tools/paths.h"
#include "topic_options.h"

namespace rgbd_sfm_fusion {
namespace {

struct Arguments {
  std::vector<std::string> bags;
  BagSelection selection;
  std::vector<std::string> for_launch;  ///< NAME:=VALUE
};

/// Arguments of replay.launch that name images and the transport by which they come.
void addImages(const std::string& kind, const std::string& topic, bool is_compressed,
               std::vector<std::string>* arguments) {
  const std::string image = withoutTransport(topic);
  if (is_compressed && image == topic)
    throw std::runtime_error(topic +
                             " has compressed images, expected a name that ends in /compressed or "
                             "/compressedDepth: play it under one, by 'rosbag play FILE " +
                             topic + ":=" + topic + "/compressed' and fusion.launch, or use fuse_bag");
  arguments->push_back(kind + "_topic:=" + image);
  if (is_compressed) arguments->push_back(kind + "_transport:=" + topic.substr(image.size() + 1));
}

std::vector<std::string> launchArguments(const Arguments& arguments, const BagInput& bag) {
  const BagSelection& used = bag.selection();
  std::string bags;
  for (const std::string& path : arguments.bags) bags += (bags.empty() ? "" : " ") + path;
  std::vector<std::string> result = {"bag:=" + bags};
  addImages("rgb", used.colour_topic, bag.isCompressed(used.colour_topic), &result);
  addImages("depth", used.depth_topic, bag.isCompressed(used.depth_topic), &result);
  if (!used.camera_info_topic.empty()) result.push_back("camera_info_topic:=" + used.camera_info_topic);
  if (!used.calibration_file.empty()) result.push_back("camera_info_url:=" + used.calibration_file);
  if (!bag.depthCameraInfoTopic().empty())
    result.push_back("depth_camera_info_topic:=" + bag.depthCameraInfoTopic());
  result.insert(result.end(), arguments.for_launch.begin(), arguments.for_launch.end());
  return result;
}

/// The speed of playing that the launch file will use.
double rateOf(const Arguments& arguments) {
  const std::string name = "rate:=";
  double rate = 1.0;
  for (const std::string& argument : arguments.for_launch) {
    if (argument.rfind(name, 0) != 0) continue;
    const std::optional<double> value = readNumber(argument.substr(name.size()));
    if (!value || !(*value > 0.0))
      throw std::runtime_error(argument + ": expected a number above 0, a multiple of real time");
    rate = *value;
  }
  return rate;
}

/// rosbag skips times without messages, but dies if such a time is too long. Such bags are refused.
void requirePlayable(const Arguments& arguments, const BagSelection& used) {
  constexpr double kLongest = 2147483647.0;  // [s] the longest time that ros::Duration holds
  BagSet bags(arguments.bags);
  std::vector<std::size_t> all, colour;
  for (std::size_t i = 0; i < bags.connections().size(); ++i) {
    all.push_back(i);
    if (bags.connections()[i].topic == used.colour_topic) colour.push_back(i);
  }
  const double before =
      toSeconds(bags.places(colour).front().entry.time - bags.places(all).front().entry.time);
  const double slowest = before / kLongest;
  if (rateOf(arguments) > slowest) return;
  throw std::runtime_error(bags.name() + ": begins " + numberText(std::floor(before / 86400.0)) +
                           " days before its first image, which rosbag cannot skip at this rate: expected a "
                           "rate above " +
                           numberText(slowest) + ", or a bag without those messages ('rosbag filter')");
}

[[noreturn]] void launch(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {"roslaunch", "rgbd_sfm_fusion", "replay.launch"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execvp(pointers.front(), pointers.data());
  throw std::runtime_error(std::string("cannot start roslaunch: ") + std::strerror(errno) +
                           "; is it installed, and ROS's setup.bash sourced?");
}

void run(Arguments arguments) {
  for (std::string& path : arguments.bags) path = absolutePath(path);
  std::string& calibration = arguments.selection.calibration_file;
  if (!calibration.empty()) calibration = absolutePath(calibration);
  const BagInput bag(arguments.bags, arguments.selection, {},
                     [](const std::string&, Stamp, const std::string&) {});  // the nodelets will say so
  requirePlayable(arguments, bag.selection());
  std::cerr << "replay: " << describe(bag.selection()) << '\n';
  launch(launchArguments(arguments, bag));
}

/// Takes the arguments of roslaunch's form, NAME:=VALUE. @return the rest
std::vector<std::string> takeLaunchArguments(int argc, char** argv, Arguments* arguments) {
  std::vector<std::string> rest;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    (word.find(":=") == std::string::npos ? rest : arguments->for_launch).push_back(word);
  }
  std::reverse(rest.begin(), rest.end());  // CLI11 takes them in this order
  return rest;
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  using namespace rgbd_sfm_fusion;
  CLI::App app("Plays bags through tracker and fusion: replay.launch with the topics that the bags have.",
               "replay");
  app.footer("ARGUMENT:=VALUE are those of replay.launch, e.g. rviz:=false rate:=0.5 exit:=true.");
  Arguments arguments;
  app.add_option("BAG", arguments.bags, "Bag with colour and registered depth images; or several, as one")
      ->required();
  addTopicOptions(&app, &arguments.selection);
  std::vector<std::string> words = takeLaunchArguments(argc, argv, &arguments);
  try {
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  try {
    run(std::move(arguments));
  } catch (const std::exception& error) {
    std::cerr << "replay: " << error.what() << '\n';
    return 1;
  }
}
