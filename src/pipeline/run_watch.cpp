// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/pipeline/run_watch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "rgbd_sfm_fusion/tools/number_text.h"
#include "rgbd_sfm_fusion/tools/text_format.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kFarthest = 10.5;       // [m] structured light ends at 10 m, whatever the device
constexpr double kLargestMaxSkew = 1.0;  // [s] the largest that the setting takes
constexpr double kRare = 0.05;           // share of something that should be frequent
constexpr std::uint64_t kFewImages = 3;  // lost images: so few are not worth a sentence
constexpr double kLongest = 1e6;         // [m] a larger value is no length
constexpr int kPixelStep = 4;

std::string number(double value, int decimals) {
  return formatNumber(value, decimals);
}

std::string milliseconds(double seconds) {
  return number(1e3 * seconds, 0) + " ms";
}

std::string percent(double share) {
  return number(100.0 * share, 0) + " %";
}

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string of(std::uint64_t part, std::uint64_t whole, const std::string& what) {
  if (whole == 1) return "the only one of the " + what;
  if (part == whole) return "all " + std::to_string(whole) + " " + what;
  return std::to_string(part) + " of " + std::to_string(whole) + " " + what;
}

/// A value of max_skew that admits a skew of `seconds`.
std::string sufficientSkew(double seconds) {
  return number(std::min(std::ceil(100.0 * seconds + 0.5) / 100.0, kLargestMaxSkew), 2);
}

}  // namespace

double DepthValues::typical() const {
  return with_depth == 0 ? std::numeric_limits<double>::quiet_NaN()
                         : std::exp(sum_of_logs / static_cast<double>(with_depth));
}

DepthValues& DepthValues::operator+=(const DepthValues& other) {
  pixels += other.pixels;
  with_depth += other.with_depth;
  too_near += other.too_near;
  too_far += other.too_far;
  implausible += other.implausible;
  sum_of_logs += other.sum_of_logs;
  step = std::gcd(step, other.step);
  return *this;
}

DepthValues valuesOf(const DepthImage& depth, double min_range, double max_range) {
  DepthValues values;
  for (int y = 0; y < depth.rows; y += kPixelStep) {
    for (int x = 0; x < depth.cols; x += kPixelStep) {
      ++values.pixels;
      const double z = static_cast<double>(depth(y, x));
      if (!(z > 0.0)) continue;
      ++values.with_depth;
      values.too_near += z < min_range ? 1 : 0;
      values.too_far += z > max_range ? 1 : 0;
      values.implausible += z > kFarthest ? 1 : 0;
      values.sum_of_logs += std::log(z);
      values.step =
          std::gcd(values.step, z < kLongest ? static_cast<std::uint64_t>(std::llround(1e3 * z)) : 1);
    }
  }
  return values;
}

void RunWatch::Frame::setFused(const FusedFrame& fused) {
  scale = fused.scale;
  counts = fused.counts;
  sfm_rejected = fused.sfm_rejected;
}

void RunWatch::LeftOutCounts::add(LeftOut why, std::uint64_t images) {
  if (why == LeftOut::kUnstamped) unstamped += images;
  if (why == LeftOut::kLate) late += images;
  if (why == LeftOut::kUnusable) unusable += images;
}

RunWatch::LeftOutCounts& RunWatch::LeftOutCounts::operator+=(const LeftOutCounts& other) {
  unstamped += other.unstamped;
  late += other.late;
  unusable += other.unusable;
  return *this;
}

/// Why images were left out, and the cure if all have the same reason.
std::string RunWatch::LeftOutCounts::text() const {
  if (unstamped == total())
    return "have a stamp of 0: give them the time when they were taken (a driver's setting, or restamp the "
           "bag)";
  if (unusable == total()) return "cannot be used, for the reasons said before";
  if (late == total()) return "have stamps that do not rise: does more than one node send them?";
  return "were left out (" + std::to_string(unstamped) + " with a stamp of 0, " + std::to_string(late) +
         " late, " + std::to_string(unusable) + " that cannot be used)";
}

RunWatch::Counts& RunWatch::Counts::operator+=(const Counts& other) {
  frames += other.frames;
  colour_left_out += other.colour_left_out;
  depth_left_out += other.depth_left_out;
  with_skew += other.with_skew;
  with_depth += other.with_depth;
  smallest_skew = std::min(smallest_skew, other.smallest_skew);
  largest_skew = std::max(largest_skew, other.largest_skew);
  values += other.values;
  with_state += other.with_state;
  tracked += other.tracked;
  lost += other.lost;
  fused += other.fused;
  tracked_and_fused += other.tracked_and_fused;
  with_scale += other.with_scale;
  rejected += other.rejected;
  pixels += other.pixels;
  return *this;
}

void RunWatch::add(double time, const Frame& frame) {
  Counts counts;
  counts.frames = 1;
  if (frame.skew) {
    counts.with_skew = 1;
    counts.smallest_skew = counts.largest_skew = std::abs(*frame.skew);
  }
  if (frame.depth) {
    counts.with_depth = 1;
    counts.values = *frame.depth;
  }
  const bool tracking = frame.state == TrackingState::kTracking;
  counts.with_state = frame.state ? 1 : 0;
  counts.tracked = tracking ? 1 : 0;
  counts.lost = frame.state == TrackingState::kLost ? 1 : 0;
  if (frame.scale) {
    counts.fused = 1;
    counts.tracked_and_fused = tracking ? 1 : 0;
    counts.with_scale = tracking && frame.scale->hasScale() ? 1 : 0;
    counts.rejected = frame.sfm_rejected ? 1 : 0;
    counts.pixels = frame.counts;
  }
  record(time, counts);
}

void RunWatch::leftOutColour(double time, LeftOut why, std::uint64_t images) {
  Counts counts;
  counts.colour_left_out.add(why, images);
  record(time, counts);
}

void RunWatch::leftOutDepth(double time, LeftOut why, std::uint64_t images) {
  Counts counts;
  counts.depth_left_out.add(why, images);
  record(time, counts);
}

void RunWatch::record(double time, const Counts& counts) {
  whole_ += counts;
  recent_.emplace_back(time, counts);
  const auto isOutside = [&](double at) { return at < time - limits_.window || at > time; };
  while (isOutside(recent_.front().first)) recent_.pop_front();
}

std::vector<std::string> RunWatch::sentences() const {
  if (whole_.frames + whole_.colour_left_out.total() == 0) return {limits_.colour + ": no image came"};
  return sentencesOf(whole_);
}

std::vector<std::string> RunWatch::recentSentences(double time) const {
  Counts counts;
  for (const auto& [at, recorded] : recent_) {
    if (at >= time - limits_.window) counts += recorded;
  }
  return sentencesOf(counts);
}

bool RunWatch::hasNothing() const {
  return whole_.tracked == 0 || (whole_.fused > 0 && whole_.pixels.total() == 0);
}

std::vector<std::string> RunWatch::sentencesOf(const Counts& counts) const {
  std::vector<std::string> sentences;
  for (const std::string& sentence :
       {aboutColour(counts), aboutDepth(counts), aboutDepthValues(counts.values), aboutTracking(counts),
        aboutFusion(counts)}) {
    if (!sentence.empty()) sentences.push_back(sentence);
  }
  return sentences;
}

std::string RunWatch::aboutColour(const Counts& counts) const {
  const std::uint64_t left_out = counts.colour_left_out.total();
  if (counts.frames > 0 || left_out == 0) return "";
  return limits_.colour + ": " + of(left_out, left_out, "images") + " " + counts.colour_left_out.text();
}

std::string RunWatch::aboutDepth(const Counts& counts) const {
  const std::uint64_t left_out = counts.depth_left_out.total();
  if (static_cast<double>(counts.with_depth) > kRare * static_cast<double>(counts.frames)) return "";
  if (counts.with_skew == 0 && left_out > 0)
    return limits_.depth + ": " + of(left_out, left_out, "images") + " " + counts.depth_left_out.text();
  if (counts.frames == 0) return "";
  if (counts.with_skew == 0)
    return limits_.depth +
           ": no image came, and SfM's scale and first map rest on depth: is that the right topic?";
  const std::string frames = of(counts.frames - counts.with_depth, counts.frames, "colour images");
  if (counts.smallest_skew <= limits_.max_skew)
    return limits_.depth + ": " + frames + " are without depth, as " +
           (left_out > 0 ? of(left_out, left_out, "images") + " " + counts.depth_left_out.text()
                         : "few of its images are within max_skew (" + milliseconds(limits_.max_skew) + ")");
  const std::string found = limits_.depth + ": for " + frames + ", no depth is within max_skew (" +
                            milliseconds(limits_.max_skew) + "): the nearest is " +
                            milliseconds(counts.smallest_skew) + " away, at worst " +
                            milliseconds(counts.largest_skew);
  if (counts.smallest_skew > kLargestMaxSkew)
    return found + "; colour and depth must be stamped by the same clock";
  return found +
         "; raise it (max_skew=" + sufficientSkew(std::min(counts.largest_skew, 2.0 * counts.smallest_skew)) +
         ")";
}

std::string RunWatch::aboutDepthValues(const DepthValues& values) const {
  if (values.pixels == 0) return "";
  if (values.with_depth == 0)
    return limits_.depth + ": depth images come, but no pixel has a depth (0 or NaN)";
  const double near = ratio(values.too_near, values.with_depth),
               far = ratio(values.too_far, values.with_depth);
  const double implausible = ratio(values.implausible, values.with_depth);
  const std::string typical =
      "; typical are " + number(values.typical(), values.typical() < 1.0 ? 4 : 1) + " m";
  const std::string unit = ": the values look like another unit (a count of 16UC1 is read as depth_scale = " +
                           numberText(limits_.depth_scale) +
                           " m, 32FC1 as metres); set depth_scale, e.g. 0.0002 "
                           "for TUM's PNGs, or convert them";
  if (near > 0.9)
    return limits_.depth + ": " + percent(near) + " of the depth values are nearer than min_range (" +
           number(limits_.min_range, 1) + " m)" + typical + unit;
  if (implausible > kRare)
    return limits_.depth + ": " + percent(implausible) + " of the depth values are beyond " +
           number(kFarthest, 1) + " m, which no sensor of this kind measures" + typical + unit;
  if (far > 0.5)
    return limits_.depth + ": " + percent(far) + " of the depth values are beyond max_range (" +
           number(limits_.max_range, 1) + " m), and so have no say in poses and scale" + typical +
           ": raise max_range if the sensor measures so far, or set depth_scale (now " +
           numberText(limits_.depth_scale) + " m) if a count of 16UC1 is another one";
  if (values.step == 5 && limits_.depth_scale == 1e-3)
    return limits_.depth +
           ": all of the depth values are multiples of 5 mm, as those of TUM's PNGs (5000 counts a "
           "metre) are when they are read as millimetres: set depth_scale=0.0002 if they are TUM's";
  return "";
}

std::string RunWatch::aboutTracking(const Counts& counts) const {
  if (counts.with_state == 0) return "";
  if (counts.tracked > 0) {
    if (counts.lost < kFewImages || ratio(counts.lost, counts.with_state) <= kRare) return "";
    return of(counts.lost, counts.with_state, "images") +
           " have no pose and the sensor's depth alone, as tracking was lost: something that moves covers "
           "much of the image, or it is blurred, shows no texture, or is much darker or brighter than it was";
  }
  const std::string found = of(counts.with_state, counts.with_state, "images") + " were not tracked (" +
                            std::to_string(counts.with_state - counts.lost) + " initialising, " +
                            std::to_string(counts.lost) + " lost)";
  if (counts.with_depth == 0) return found + ": a start needs an image with depth";
  return found + ": a start needs texture where there is depth, and motion that is not too fast";
}

std::string RunWatch::aboutFusion(const Counts& counts) const {
  if (counts.tracked_and_fused == 0) return "";
  const std::string frames = of(counts.tracked_and_fused, counts.tracked_and_fused, "tracked images");
  if (counts.with_scale == 0)
    return "SfM's depth had no scale in " + frames +
           ", and is not used: it needs sensor depth at image edges that SfM sees, and motion sideways";
  if (static_cast<double>(counts.rejected) > 0.5 * static_cast<double>(counts.tracked_and_fused))
    return "SfM's depth contradicts the sensor's in " +
           of(counts.rejected, counts.tracked_and_fused, "tracked images") +
           ", and is not used there: depth is not registered to colour, or the camera moves too far between "
           "images, as when some are left out";
  if (counts.pixels.sfm_only > 0) return "";
  if (counts.values.with_depth >= counts.values.pixels - counts.values.pixels / 20)
    return "";  // nothing to fill
  return "nothing comes from SfM alone in " + frames +
         ": where the sensor has no depth, SfM has none that is good enough";
}

}  // namespace rgbd_sfm_fusion
