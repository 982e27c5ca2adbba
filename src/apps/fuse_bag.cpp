// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// fuse_bag INPUT.bag … --output OUT.bag --results DIR …: does what the nodelets do, over a bag, as fast as
/// possible.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "rgbd_sfm_fusion/input/registration.h"
#include "rgbd_sfm_fusion/odometry/self_calibration.h"
#include "rgbd_sfm_fusion/pipeline/pipeline.h"
#include "rgbd_sfm_fusion/pipeline/run_watch.h"
#include "rgbd_sfm_fusion/ros/bag_input.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/picture.h"
#include "rgbd_sfm_fusion/ros/result_bag.h"
#include "rgbd_sfm_fusion/settings/settings.h"
#include "rgbd_sfm_fusion/tools/interruption.h"
#include "rgbd_sfm_fusion/tools/left_out.h"
#include "rgbd_sfm_fusion/tools/ordered_worker.h"
#include "rgbd_sfm_fusion/tools/paths.h"
#include "rgbd_sfm_fusion/tools/pending_file.h"
#include "rgbd_sfm_fusion/tools/progress.h"
#include "rgbd_sfm_fusion/tools/run_page.h"
#include "rgbd_sfm_fusion/tools/run_report.h"
#include "rgbd_sfm_fusion/tools/stopwatch.h"
#include "rgbd_sfm_fusion/video/preview_recorder.h"
#include "topic_options.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kFramesInFlight = 4;  // before each thread

struct Arguments {
  std::vector<std::string> inputs;
  std::string output;
  std::string results;
  std::vector<std::string> configs;  ///< files of settings
  std::vector<std::string> assignments;
  std::vector<std::string> more_topics;
  std::string preview;  ///< empty: not wanted; the same for the next two
  std::string report;
  std::string truth;
  std::string compression = "none";
  BagSelection selection;
};

Settings readSettings(const Arguments& arguments) {
  Settings settings;
  loadSettings(arguments.configs, &settings);
  for (const std::string& assignment : arguments.assignments) applyAssignment(assignment, &settings);
  validate(settings);
  return settings;
}

void warn(const std::string& message) {
  std::cerr << "fuse_bag: warning: " << message << '\n';
}

/// Refuses to write a file that is also read.
void requireNoInputs(const Arguments& arguments) {
  std::vector<std::string> inputs = arguments.inputs;
  inputs.insert(inputs.end(), arguments.configs.begin(), arguments.configs.end());
  if (!arguments.selection.calibration_file.empty()) inputs.push_back(arguments.selection.calibration_file);
  requireNoInput(arguments.output, inputs);
  if (!arguments.report.empty()) requireNoInput(arguments.report, inputs);
  if (arguments.report == arguments.output)
    throw std::runtime_error("--report and --output are the same file, " + arguments.output);
  for (const std::string& name : RunReport::fileNames())
    requireNoInput(arguments.results + "/" + name, inputs);
}

void warnOfDepthCamera(const BagInput& bag) {
  if (!bag.depthCalibrationProblem().empty())
    warn("the depth camera_info cannot be read; that of colour is used: " + bag.depthCalibrationProblem());
  if (!bag.depthCalibration()) return;
  const CameraCalibration colour =
      bag.depthIsRectified() ? ofRectifiedImages(bag.calibration()) : bag.calibration();
  const auto difference = differenceOfDepthCamera(colour, *bag.depthCalibration());
  if (difference) {
    warn("the depth camera_info differs from that of colour, which is used: " + *difference);
  }
}

std::string doubtOf(const BagInput::Pair& pair) {
  if (!pair.depth) return "";
  return doubtOfRegistration(withoutSlash(pair.colour->header.frame_id),
                             withoutSlash(pair.depth->header.frame_id));
}

RunInput inputOf(const Arguments& arguments, const BagSelection& used) {
  RunInput input;
  for (const std::string& bag : arguments.inputs) input.bags.push_back(absolutePath(bag));
  input.colour = used.colour_topic;
  input.depth = used.depth_topic;
  input.calibration =
      used.calibration_file.empty() ? used.camera_info_topic : absolutePath(used.calibration_file);
  input.start = used.start;
  input.duration = used.duration;
  return input;
}

std::vector<std::string> moreTopics(const Arguments& arguments) {
  std::vector<std::string> topics = arguments.more_topics;
  if (!arguments.report.empty())
    topics.insert(topics.end(), RunPage::topics().begin(), RunPage::topics().end());
  return topics;
}

/// Where the results of a frame go.
struct Sinks {
  Sinks(const Arguments& arguments, const Settings& settings, const BagSelection& used)
      : bag(arguments.output, moreTopics(arguments), bagCompression(arguments.compression)),
        report(arguments.results, settings, inputOf(arguments, used)) {
    // The page is made after `report`, as the page may go into the folder of results.
    if (!arguments.report.empty()) page = std::make_unique<RunPage>(arguments.report, arguments.truth);
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
  std::unique_ptr<PreviewRecorder> preview;  ///< null: not wanted; the same for `page`
  std::unique_ptr<RunPage> page;             ///< made from the files, once they are complete
};

struct WorkItem {
  MappedFrame mapped;
  std::string frame_id;
  RunWatch::Frame watched;
  cv::Mat picture;  ///< rectified colour image; empty: not needed
};

/// Makes frames from pairs of images. Images that cannot be used are left out.
class Preparation {
 public:
  Preparation(const Rectifier& rectifier, const BagSelection& topics, const Settings& settings,
              LeftOutMessages& left_out)
      : rectifier_(rectifier),
        topics_(topics),
        depth_scale_(settings.run.depth_scale),
        saturated_depth_(static_cast<double>(settings.fusion.noise.saturated_depth)),
        left_out_(left_out) {}

  std::optional<RgbdFrame> operator()(const BagInput::Pair& pair) {
    RgbdFrame frame;
    const bool usable = attempt(topics_.colour_topic, pair.stamp, [&] {
      frame = prepareFrame(rectifier_, toRawImage(pair.colour, pair.stamp), {});
    });
    if (!usable) return std::nullopt;
    attempt(topics_.depth_topic, pair.depth_stamp, [&] {
      frame.depth =
          prepareDepth(rectifier_, toRawImage(pair.depth, pair.depth_stamp), depth_scale_, saturated_depth_);
      if (!frame.depth.empty()) frame.depth_stamp = pair.depth_stamp;
    });
    return frame;
  }

 private:
  template <class Function>
  bool attempt(const std::string& topic, Stamp stamp, Function function) {
    try {
      function();
      return true;
    } catch (const std::exception& error) {
      left_out_.add(topic, stamp, error.what());
      return false;
    }
  }

  const Rectifier& rectifier_;
  const BagSelection& topics_;
  double depth_scale_, saturated_depth_;  // [m]
  LeftOutMessages& left_out_;
};

RunWatch::Limits limitsOf(const Settings& settings, const BagSelection& topics) {
  RunWatch::Limits limits;
  limits.max_skew = settings.association.max_skew;
  limits.min_range = static_cast<double>(settings.fusion.noise.min_range);
  limits.max_range = static_cast<double>(settings.fusion.noise.max_range);
  limits.depth_scale = settings.run.depth_scale;
  limits.colour = topics.colour_topic;
  limits.depth = topics.depth_topic;
  return limits;
}

RunWatch::Frame watched(const BagInput::Pair& pair, const MappedFrame& mapped,
                        const RunWatch::Limits& limits) {
  RunWatch::Frame frame;
  if (pair.nearest_depth != kNoStamp) frame.skew = toSeconds(pair.nearest_depth - pair.stamp);
  if (!mapped.frame.depth.empty())
    frame.depth = valuesOf(mapped.frame.depth, limits.min_range, limits.max_range);
  frame.state = mapped.tracked.state;
  return frame;
}

/// Reports the images that did not become frames.
void reportLeftOut(const BagInput& bag, const BagSelection& topics, const LeftOutMessages& left_out,
                   RunWatch& watch) {
  using LeftOut = RunWatch::LeftOut;
  const StreamCounts colour = bag.colourCounts(), depth = bag.depthCounts();
  watch.leftOutColour(0.0, LeftOut::kUnstamped, colour.unstamped);
  watch.leftOutColour(0.0, LeftOut::kLate, colour.late);
  watch.leftOutColour(0.0, LeftOut::kUnusable, left_out.count(topics.colour_topic));
  watch.leftOutDepth(0.0, LeftOut::kUnstamped, depth.unstamped);
  watch.leftOutDepth(0.0, LeftOut::kLate, depth.late);
  watch.leftOutDepth(0.0, LeftOut::kUnusable, left_out.count(topics.depth_topic));
  for (const auto& [topic, counts] : {std::pair(topics.colour_topic, colour), {topics.depth_topic, depth}}) {
    const std::string all = " of " + std::to_string(counts.accepted + counts.leftOut()) + " images ";
    if (counts.late > 0)
      warn(topic + ": " + std::to_string(counts.late) + all +
           "were late (stamped before an earlier one) and are left out");
    if (counts.unstamped > 0 && counts.accepted > 0)
      warn(topic + ": " + std::to_string(counts.unstamped) + all + "have a stamp of 0 and are left out");
  }
  for (const std::string& line : left_out.summary()) warn(line);
}

void run(const Arguments& arguments) {
  const Settings settings = readSettings(arguments);
  cv::setNumThreads(1);  // the setting `threads` says how many threads there are
  requireNoInputs(arguments);
  LeftOutMessages left_out(warn);
  BagInput bag(arguments.inputs, arguments.selection, settings.association,
               [&left_out](const std::string& topic, Stamp recorded, const std::string& reason) {
                 left_out.add(topic, recorded, reason);
               });
  const BagSelection& topics = bag.selection();
  std::cerr << "fuse_bag: " << describe(topics) << '\n';
  if (!bag.assumption().empty()) std::cerr << "fuse_bag: " << bag.assumption() << '\n';
  Pipeline pipeline(bag.calibration(), settings.odometry, settings.fusion, bag.depthCalibration(),
                    bag.depthIsRectified());
  warnOfDepthCamera(bag);
  Sinks sinks(arguments, settings, topics);
  const RunWatch::Limits limits = limitsOf(settings, topics);
  RunWatch watch(limits);

  Progress progress(bag.size());
  std::size_t done = 0;
  std::uint32_t run = kFirstRun;
  OrderedWorker<WorkItem> fusion(settings.run.threads > 1 ? kFramesInFlight : 0, [&](WorkItem item) {
    const PipelineResult result = pipeline.fuse(std::move(item.mapped));
    if (result.mapped.run != run) warn("stamps went back: started anew");
    run = result.mapped.run;
    sinks.bag.write(result, pipeline.camera(), item.frame_id, item.picture);
    if (sinks.preview) sinks.preview->add(result, item.picture);
    sinks.report.add(result);
    item.watched.setFused(result.fused);
    watch.add(toSeconds(result.fused.stamp), item.watched);
    progress.show(++done);
  });
  OrderedWorker<WorkItem> mapping(settings.run.threads > 2 ? kFramesInFlight : 0, [&](WorkItem item) {
    item.mapped = pipeline.map(std::move(item.mapped));
    fusion.push(std::move(item));
  });
  Preparation prepare(pipeline.rectifier(), topics, settings, left_out);
  RegistrationWatch registration;
  TrackingResult last;
  bool has_doubted = false;
  const auto doubtRegistration = [&](const std::string& doubt) {
    if (doubt.empty() || has_doubted) return;
    warn(topics.depth_topic + ": " + doubt);
    has_doubted = true;
  };
  while (const auto pair = bag.next()) {
    throwIfInterrupted();
    doubtRegistration(doubtOf(*pair));
    Stopwatch stopwatch;
    std::optional<RgbdFrame> frame = prepare(*pair);
    const double preparation_ms = stopwatch.lap();
    if (!frame) continue;
    if (!has_doubted) {
      registration.add(frame->grey, frame->depth);
      doubtRegistration(registration.doubt());
    }
    mapping.waitForAllBut(1);  // the next line waits for mapping, which may have ended with an error
    MappedFrame tracked = pipeline.track(*std::move(frame), pair->run);
    tracked.preparation_ms = preparation_ms;
    last = tracked.tracked;
    const RunWatch::Frame facts = watched(*pair, tracked, limits);
    cv::Mat picture;
    if (sinks.needPicture())
      picture = pipeline.rectifier().rectifyPicture(toPicture(toRawImage(pair->colour, pair->stamp))).clone();
    mapping.push({std::move(tracked), withoutSlash(pair->colour->header.frame_id), facts, picture});
  }
  mapping.finish();
  fusion.finish();
  reportLeftOut(bag, topics, left_out, watch);
  for (const std::string& sentence : watch.sentences()) warn(sentence);
  if (const std::string remark = remarkOnCalibration(last); !remark.empty()) warn(remark);
  if (const std::string remark = remarkOnDepthDelay(last); !remark.empty())
    std::cerr << "fuse_bag: " << remark << '\n';
  if (watch.hasNothing())
    throw std::runtime_error("nothing could be tracked or fused, so nothing is written");
  sinks.commit();
  std::cout << sinks.report.summaryText() << std::flush;
  if (sinks.page) sinks.page->make(arguments.output, arguments.results);
}

void addOptions(CLI::App* app, Arguments* arguments) {
  BagSelection* selection = &arguments->selection;
  app->add_option("INPUT.bag", arguments->inputs,
                  "Bag with colour and registered depth images; or several, played as one")
      ->required();
  app->add_option("--output", arguments->output, "Bag of fused frames to write")->required();
  app->add_option(
         "--results", arguments->results,
         "Folder for trajectory.txt, frames.csv, keyframes.csv, timing.csv, summary.json and settings.yaml")
      ->required();
  app->add_option(
         "--config", arguments->configs,
         "YAML file of settings, like config/default.yaml, config/expert.yaml and config/paper.yaml; any "
         "number of times")
      ->allow_extra_args(false);
  app->add_option("--set", arguments->assignments, "Settings as key=value, applied after those of files");
  app->add_option("--start", selection->start, "Seconds to skip, from the first image on")
      ->check(CLI::NonNegativeNumber);
  app->add_option("--duration", selection->duration, "Seconds to use (default: all)")
      ->check(CLI::PositiveNumber);
  addTopicOptions(app, selection);
  app->add_option("--topics", arguments->more_topics, "Topics to write beyond the usual ones");
  app->add_option("--preview", arguments->preview,
                  "Video (.avi, .mp4, .mkv, .mov) or folder of pictures that show each frame's result");
  CLI::Option* report = app->add_option(
      "--report", arguments->report,
      "HTML page of the run: what was added, how sure it is, frames, plots and settings. Writes "
      "also /fusion/sfm_depth, /fusion/sfm_variance and /fusion/image_rect, which it shows: about "
      "twice as much");
  app->add_option("--truth", arguments->truth,
                  "For the page: sequence in the layout of the TUM benchmark, with true poses and depth")
      ->needs(report);
  app->add_option("--compress", arguments->compression,
                  "Compression of the output bag: none (default), lz4 (fast) or bz2 (slow)")
      ->check(CLI::IsMember({"none", "lz4", "bz2"}));
}

void expandHome(Arguments* arguments) {
  for (std::vector<std::string>* paths : {&arguments->inputs, &arguments->configs}) {
    for (std::string& path : *paths) path = withHome(path);
  }
  for (std::string* path : {&arguments->output, &arguments->results, &arguments->selection.calibration_file,
                            &arguments->report, &arguments->truth})
    *path = withHome(*path);
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  using namespace rgbd_sfm_fusion;
  CLI::App app("Fuses the depth of an RGB-D bag with depth from structure from motion.", "fuse_bag");
  Arguments arguments;
  addOptions(&app, &arguments);
  CLI11_PARSE(app, argc, argv);
  expandHome(&arguments);
  catchSignals();
  try {
    run(arguments);
  } catch (const Interrupted& error) {
    std::cerr << "fuse_bag: " << error.what() << '\n';
    return kExitInterrupted;
  } catch (const std::exception& error) {
    std::cerr << "fuse_bag: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
