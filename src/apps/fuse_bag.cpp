// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// fuse_bag INPUT.bag --output OUT.bag --results DIR …: what the nodelets do, over a bag, as fast as it goes.
#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>
#include <memory>
#include <stdexcept>

#include "rgbd_sfm_fusion/pipeline/pipeline.h"
#include "rgbd_sfm_fusion/preview/preview_recorder.h"
#include "rgbd_sfm_fusion/ros/bag_input.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/picture.h"
#include "rgbd_sfm_fusion/ros/result_bag.h"
#include "rgbd_sfm_fusion/settings/settings.h"
#include "rgbd_sfm_fusion/tools/ordered_worker.h"
#include "rgbd_sfm_fusion/tools/progress.h"
#include "rgbd_sfm_fusion/tools/run_report.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kFramesInFlight = 4;
constexpr int kExitInterrupted = 130;  // as a shell has it for Ctrl-C

volatile std::sig_atomic_t interrupted = 0;  // all that a signal handler may touch

struct Arguments {
  std::string input;
  std::string output;
  std::string results;
  std::string config;
  std::vector<std::string> assignments;
  std::vector<std::string> more_topics;
  std::string preview;  ///< empty: none
  BagSelection selection;
};

Settings readSettings(const Arguments& arguments) {
  Settings settings;
  if (!arguments.config.empty()) loadSettings(arguments.config, &settings);
  for (const std::string& assignment : arguments.assignments) applyAssignment(assignment, &settings);
  validate(settings);
  return settings;
}

RawImage toRawImage(const sensor_msgs::ImageConstPtr& image, Stamp stamp) {
  if (!image) return {};
  return {stamp, image->encoding, viewImage(image)};
}

void warnOfDepthCamera(const BagInput& bag, const CameraCalibration& colour) {
  if (!bag.depthCameraInfo()) return;
  const auto difference = differenceOfDepthCamera(colour, toCalibration(*bag.depthCameraInfo()));
  if (difference) {
    std::cerr << "fuse_bag: warning: the depth camera_info is not that of colour, which is used: "
              << *difference << '\n';
  }
}

/// Where the results of a frame go.
struct Sinks {
  Sinks(const Arguments& arguments, const Settings& settings)
      : bag(arguments.output, arguments.more_topics), report(arguments.results, settings) {
    if (arguments.preview.empty()) return;
    preview = std::make_unique<PreviewRecorder>(arguments.preview);
    if (!preview->writer().usedFolderInstead()) return;
    std::cerr << "fuse_bag: OpenCV has no codec for " << arguments.preview << ": writing pictures to "
              << preview->writer().path() << "/\n";
  }

  bool needPicture() const { return preview || bag.needsPicture(); }

  void commit() {
    report.finish();
    if (preview) preview->finish();
    bag.commit();
    report.commit();
    if (preview) preview->commit();
  }

  ResultBag bag;
  RunReport report;
  std::unique_ptr<PreviewRecorder> preview;  ///< null: not wanted
};

struct WorkItem {
  MappedFrame mapped;
  std::string frame_id;
  cv::Mat picture;  ///< rectified colour image; empty: not needed
};

void run(const Arguments& arguments) {
  const Settings settings = readSettings(arguments);
  cv::setNumThreads(1);  // `threads` says how many there are
  BagInput bag(arguments.input, arguments.selection, settings.association);
  const CameraCalibration calibration = toCalibration(bag.cameraInfo());
  Pipeline pipeline(calibration, settings.odometry, settings.fusion);
  warnOfDepthCamera(bag, calibration);
  Sinks sinks(arguments, settings);

  Progress progress(bag.size());
  std::size_t done = 0;
  OrderedWorker<WorkItem> fusion(settings.run.threads > 1 ? kFramesInFlight : 0, [&](WorkItem item) {
    const PipelineResult result = pipeline.fuse(std::move(item.mapped));
    if (result.mapped.restarted) std::cerr << "fuse_bag: stamps went back: started anew\n";
    sinks.bag.write(result, pipeline.camera(), item.frame_id, item.picture);
    if (sinks.preview) sinks.preview->add(result, item.picture);
    sinks.report.add(result);
    progress.show(++done);
  });
  while (const auto pair = bag.next()) {
    if (interrupted != 0) throw std::runtime_error("interrupted");
    const RawImage colour = toRawImage(pair->colour, pair->stamp);
    const RawImage depth = toRawImage(pair->depth, pair->depth_stamp);
    MappedFrame mapped = pipeline.map(colour, depth);
    const cv::Mat picture =
        sinks.needPicture() ? pipeline.rectifier().rectifyPicture(toPicture(colour)).clone() : cv::Mat();
    fusion.push({std::move(mapped), pair->colour->header.frame_id, picture});
  }
  fusion.finish();
  sinks.commit();
  std::cout << sinks.report.summaryText();
}

void addOptions(CLI::App* app, Arguments* arguments) {
  BagSelection* selection = &arguments->selection;
  app->add_option("INPUT.bag", arguments->input, "Bag with colour and registered depth images")->required();
  app->add_option("--output", arguments->output, "Bag of fused frames to write")->required();
  app->add_option("--results", arguments->results,
                  "Folder for trajectory.txt, frames.csv, keyframes.csv, timing.csv and summary.json")
      ->required();
  app->add_option("--config", arguments->config,
                  "YAML file of settings (default: those of config/default.yaml)");
  app->add_option("--set", arguments->assignments, "Settings as key=value, after the file's");
  app->add_option("--start", selection->start, "Seconds of the bag to skip")->check(CLI::NonNegativeNumber);
  app->add_option("--duration", selection->duration, "Seconds of the bag to use (default: all)")
      ->check(CLI::PositiveNumber);
  app->add_option("--rgb", selection->colour_topic, "Topic of the colour images")->capture_default_str();
  app->add_option("--depth", selection->depth_topic, "Topic of the depth images, registered to colour")
      ->capture_default_str();
  app->add_option("--camera-info", selection->camera_info_topic, "Topic of the colour camera's calibration")
      ->capture_default_str();
  app->add_option("--topics", arguments->more_topics, "Topics to write beyond the usual ones");
  app->add_option("--preview", arguments->preview,
                  "Video (.avi, .mp4, .mkv, .mov) or folder of pictures that show each frame's result");
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  using namespace rgbd_sfm_fusion;
  CLI::App app("Fuses the depth of an RGB-D bag with depth from structure from motion.", "fuse_bag");
  Arguments arguments;
  addOptions(&app, &arguments);
  CLI11_PARSE(app, argc, argv);
  const auto interrupt = [](int) { interrupted = 1; };
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "fuse_bag: " << error.what() << '\n';
    return interrupted != 0 ? kExitInterrupted : 1;
  }
  return 0;
}
