// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/fusion_messages.h"

#include <sensor_msgs/image_encodings.h>

#include <limits>
#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/preview/source_colours.h"
#include "rgbd_sfm_fusion/ros/conversions.h"

namespace rgbd_sfm_fusion {
namespace {

namespace encodings = sensor_msgs::image_encodings;
using std_msgs::Header;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

sensor_msgs::ImagePtr makeMean(const Header& header, const FusedFrame& fused) {
  return toImage(header, encodings::TYPE_32FC1, fused.depth.mean);
}

sensor_msgs::ImagePtr makeVariance(const Header& header, const FusedFrame& fused) {
  return toImage(header, encodings::TYPE_32FC1, fused.depth.variance);
}

sensor_msgs::ImagePtr makeStandardDeviation(const Header& header, const FusedFrame& fused) {
  cv::Mat sigma;
  cv::sqrt(fused.depth.variance, sigma);
  return toImage(header, encodings::TYPE_32FC1, sigma);
}

sensor_msgs::ImagePtr makeProvenance(const Header& header, const FusedFrame& fused) {
  return toImage(header, encodings::MONO8, fused.provenance);
}

sensor_msgs::ImagePtr makeProvenanceColour(const Header& header, const FusedFrame& fused) {
  return toImage(header, encodings::RGB8, paintSources(fused.provenance));
}

sensor_msgs::ImagePtr makeDisagreement(const Header& header, const FusedFrame& fused) {
  return toImage(header, encodings::MONO8, fused.disagreement);
}

/// A frame without SfM depth has an image too: one without values.
sensor_msgs::ImagePtr makeSfm(const Header& header, const FusedFrame& fused, const cv::Mat_<float>& image) {
  const cv::Mat_<float> none(fused.depth.mean.size(), kNoDepth);
  return toImage(header, encodings::TYPE_32FC1, image.empty() ? none : image);
}

sensor_msgs::ImagePtr makeSfmDepth(const Header& header, const FusedFrame& fused) {
  return makeSfm(header, fused, fused.sfm.mean);
}

sensor_msgs::ImagePtr makeSfmVariance(const Header& header, const FusedFrame& fused) {
  return makeSfm(header, fused, fused.sfm.variance);
}

}  // namespace

const std::vector<FusionImageTopic>& fusionImageTopics() {
  static const std::vector<FusionImageTopic> topics = {
      {"mean", false, makeMean},
      {"variance", false, makeVariance},
      {"standard_deviation", false, makeStandardDeviation},
      {"provenance", false, makeProvenance},
      {"provenance_color", true, makeProvenanceColour},
      {"disagreement", false, makeDisagreement},
      {"sfm_depth", false, makeSfmDepth},
      {"sfm_variance", false, makeSfmVariance},
  };
  return topics;
}

sensor_msgs::ImagePtr toPictureMessage(const Header& header, const cv::Mat& picture) {
  return toImage(header, picture.channels() == 3 ? encodings::RGB8 : encodings::MONO8, picture);
}

Scale toScaleMessage(const Header& header, const ScaleEstimate& scale) {
  Scale message;
  message.header = header;
  message.scale = scale.alpha;
  message.standard_deviation = scale.sigma;
  message.inliers = scale.inliers;
  message.residual = scale.residual;
  message.refused = scale.refused;
  return message;
}

FusionStatistics toStatisticsMessage(const Header& header, const FusedFrame& fused,
                                     const FusionTotals& totals, double latency, double skew) {
  FusionStatistics message;
  message.header = header;
  message.pixels_with_depth = static_cast<std::uint32_t>(fused.counts.total());
  message.sensor_only = fused.counts.sensorOnlyShare();
  message.sfm_only = fused.counts.sfmOnlyShare();
  message.fused = fused.counts.fusedShare();
  message.disagreement = disagreementShare(fused.disagreeing, fused.counts);
  message.completed = fused.counts.completedShare();
  message.refilled = fused.counts.refilledShare();
  message.total_pixels_with_depth = totals.counts.total();
  message.total_sensor_only = totals.counts.sensorOnlyShare();
  message.total_sfm_only = totals.counts.sfmOnlyShare();
  message.total_fused = totals.counts.fusedShare();
  message.total_disagreement = disagreementShare(totals.disagreeing, totals.counts);
  message.total_completed = totals.counts.completedShare();
  message.total_refilled = totals.counts.refilledShare();
  message.latency = latency;
  message.skew = skew;
  return message;
}

double disagreementShare(std::uint64_t disagreeing, const ProvenanceCounts& counts) {
  return counts.total() == 0 ? 0.0 : static_cast<double>(disagreeing) / static_cast<double>(counts.total());
}

double skewSeconds(Stamp colour, Stamp depth) {
  return depth == kNoStamp ? kNone : toSeconds(depth - colour);
}

}  // namespace rgbd_sfm_fusion
