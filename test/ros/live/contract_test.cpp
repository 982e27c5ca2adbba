// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Topics of tracker and fusion are as docs/topics.md has them: type, encoding, unit, frame, stamp. Poses and
/// tf: poses_test.cpp.
#include <dynamic_reconfigure/Reconfigure.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "contract_fixture.h"

namespace rgbd_sfm_fusion {
namespace {

TEST_F(ContractTest, FusedImagesHaveTheEncodingSizeFrameAndStampOfTheContract) {
  camera_.hole = 0.4F;
  const Stamp stamp = sendFrames(12);
  for (auto* inbox : {&outputs_.mean, &outputs_.variance, &outputs_.standard_deviation, &outputs_.sfm_depth,
                      &outputs_.sfm_variance}) {
    expectImage(*inbox, stamp, "32FC1");
  }
  expectImage(outputs_.provenance, stamp, "mono8");
  expectImage(outputs_.disagreement, stamp, "mono8");
  expectImage(outputs_.provenance_color, stamp, "rgb8");
}

TEST_F(ContractTest, EveryFrameIsFusedOnce) {
  std::vector<Stamp> stamps;
  for (int frame = 0; frame < 30; ++frame) {
    stamps.push_back(live_camera_.send(camera_, frame));
    spinUntil([] { return false; }, 0.1);
  }
  ASSERT_TRUE(outputs_.mean.at(stamps.back()));
  const auto of = [&](const auto& inbox) {
    std::vector<Stamp> found;
    for (const auto& message : inbox.messages) found.push_back(fromRosTime(message->header.stamp));
    return found;
  };
  EXPECT_EQ(of(outputs_.mean), stamps);
  EXPECT_EQ(of(outputs_.frame), stamps);
}

TEST_F(ContractTest, FusedDepthIsInMetresWithAVarianceAndASource) {
  camera_.hole = 0.4F;
  const Stamp stamp = sendFrames(15);
  const cv::Mat_<float> mean = viewImage(outputs_.mean.at(stamp));
  const cv::Mat_<float> variance = viewImage(outputs_.variance.at(stamp));
  const cv::Mat_<float> sigma = viewImage(outputs_.standard_deviation.at(stamp));
  const cv::Mat_<std::uint8_t> provenance = viewImage(outputs_.provenance.at(stamp));
  int count[5] = {};
  std::vector<float> errors;
  for (int y = 0; y < mean.rows; ++y) {
    for (int x = 0; x < mean.cols; ++x) {
      ASSERT_LE(provenance(y, x), 4);
      ++count[provenance(y, x)];
      ASSERT_EQ(provenance(y, x) != 0, std::isfinite(mean(y, x)));
      if (provenance(y, x) == 0) continue;
      ASSERT_TRUE(std::isfinite(variance(y, x)) && variance(y, x) > 0.0F);
      ASSERT_FLOAT_EQ(sigma(y, x), std::sqrt(variance(y, x)));
      errors.push_back(std::abs(mean(y, x) / camera_.depth(14, x) - 1.0F));
    }
  }
  EXPECT_GT(count[1] + count[3], 320 * 240 / 2);
  ASSERT_FALSE(errors.empty());
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.02F);
}

TEST_F(ContractTest, CameraInfoIsTheRectifiedCamera) {
  const Stamp stamp = sendFrames(1);
  for (auto* inbox : {&outputs_.info, &outputs_.keyframe_info}) {
    const auto info = inbox->at(stamp);
    ASSERT_TRUE(info) << inbox->topic();
    EXPECT_EQ(info->header.frame_id, camera_.frame_id);
    for (const double d : info->D) EXPECT_EQ(d, 0.0);
    EXPECT_EQ(rectifiedCamera(toCalibration(*info)), camera_.camera());
  }
}

TEST_F(ContractTest, ScaleAndStatisticsBelongToTheFrame) {
  const Stamp stamp = sendFrames(12);
  const auto scale = outputs_.scale.at(stamp);
  ASSERT_TRUE(scale);
  EXPECT_EQ(scale->header.frame_id, camera_.frame_id);
  EXPECT_FALSE(scale->refused);
  EXPECT_NEAR(scale->scale, 1.0, 0.1);
  EXPECT_GT(scale->standard_deviation, 0.0);
  EXPECT_GT(scale->inliers, 200U) << "scale_min_pixels";
  const auto statistics = outputs_.statistics.at(stamp);
  ASSERT_TRUE(statistics);
  EXPECT_NEAR(statistics->sensor_only + statistics->sfm_only + statistics->fused, 1.0, 1e-9);
  EXPECT_NEAR(statistics->total_sensor_only + statistics->total_sfm_only + statistics->total_fused, 1.0,
              1e-9);
  EXPECT_GT(statistics->total_pixels_with_depth, 10U * statistics->pixels_with_depth);
  EXPECT_EQ(statistics->skew, 0.0);
  EXPECT_TRUE(std::isfinite(statistics->latency));
}

TEST_F(ContractTest, TheFirstFrameIsItsOwnKeyframe) {
  const Stamp first = sendFrames(1);
  const auto frame = outputs_.frame.at(first);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->state, TrackedFrame::TRACKING);
  EXPECT_EQ(frame->header.frame_id, camera_.frame_id);
  EXPECT_EQ(fromRosTime(frame->keyframe_stamp), first);
  EXPECT_EQ(fromRosTime(frame->depth_stamp), first);
  EXPECT_EQ(frame->T_frame_keyframe.rotation.w, 1.0);
  EXPECT_EQ(frame->T_frame_keyframe.translation.x, 0.0);
}

TEST_F(ContractTest, TrackedFramesReferToTheirKeyframe) {
  const Stamp first = sendFrames(1);
  const Stamp stamp = sendFrames(3, 1);
  const auto frame = outputs_.frame.at(stamp);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->state, TrackedFrame::TRACKING);
  EXPECT_EQ(fromRosTime(frame->keyframe_stamp), first);
  EXPECT_EQ(frame->keyframe_revision, 2U) << "the map as of the frame before, just after a start";
  // p_frame = T p_keyframe: the camera went to +x, so points go to -x.
  EXPECT_NEAR(frame->T_frame_keyframe.translation.x, -3 * FakeCamera::kStep, 0.01);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_GT(frame->covariance[7 * i], 0.0);
    for (std::size_t j = 0; j < 6; ++j) {
      EXPECT_NEAR(frame->covariance[6 * i + j], frame->covariance[6 * j + i], 1e-9);
    }
  }
}

TEST_F(ContractTest, KeyframesComeWithEveryRefinementInProcessAndWithTheirImages) {
  const Stamp first = sendFrames(4);
  static_cast<void>(first);
  const Stamp keyframe_stamp = camera_.stamp(0);
  const auto keyframe = outputs_.keyframe.at(keyframe_stamp);
  ASSERT_TRUE(keyframe);
  EXPECT_EQ(keyframe->header.frame_id, camera_.frame_id);
  EXPECT_EQ(keyframe->K[0], camera_.camera().fx);
  EXPECT_EQ(keyframe->depth.encoding, "32FC1");
  EXPECT_EQ(keyframe->variance.encoding, "32FC1");
  std::set<std::uint32_t> revisions;
  spinUntil([&] {
    for (const auto& message : outputs_.keyframe.messages) {
      if (fromRosTime(message->header.stamp) == keyframe_stamp) revisions.insert(message->revision);
    }
    return revisions.size() >= 4;
  });
  EXPECT_EQ(revisions, (std::set<std::uint32_t>{0, 1, 2, 3}));
  expectImage(outputs_.keyframe_image, keyframe_stamp, "mono8");
  expectImage(outputs_.keyframe_depth, keyframe_stamp, "32FC1");
  expectImage(outputs_.keyframe_variance, keyframe_stamp, "32FC1");
  const auto pose = outputs_.keyframe_pose.at(keyframe_stamp);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->header.frame_id, "odom");
}

TEST_F(ContractTest, BothDepthEncodingsGiveTheSame) {
  const Stamp stamp = sendFrames(6);
  const auto integer = outputs_.mean.at(stamp);
  callReset();
  camera_.first_stamp = freshStamp();
  camera_.depth_encoding = "32FC1";
  const Stamp later = sendFrames(6);
  const auto floating = outputs_.mean.at(later);
  ASSERT_TRUE(integer && floating);
  EXPECT_EQ(integer->data, floating->data);
}

TEST_F(ContractTest, AllColourEncodingsGiveTheSame) {
  std::vector<sensor_msgs::ImageConstPtr> means;
  for (const char* encoding : {"rgb8", "bgr8", "mono8"}) {
    callReset();
    camera_.first_stamp = freshStamp();
    camera_.colour_encoding = encoding;
    means.push_back(outputs_.mean.at(sendFrames(6)));
    ASSERT_TRUE(means.back()) << encoding;
  }
  EXPECT_EQ(means[0]->data, means[1]->data);
  EXPECT_EQ(means[0]->data, means[2]->data);
}

TEST_F(ContractTest, ResetStartsANewRun) {
  const Stamp before = sendFrames(5);
  callReset();
  const Stamp stamp = sendFrames(1, 5);
  const auto old_frame = outputs_.frame.at(before);
  const auto frame = outputs_.frame.at(stamp);
  ASSERT_TRUE(old_frame && frame);
  EXPECT_EQ(frame->run, old_frame->run + 1);
  EXPECT_EQ(fromRosTime(frame->keyframe_stamp), stamp);
  EXPECT_EQ(outputs_.path.at(stamp)->poses.size(), 1U);
  EXPECT_EQ(outputs_.statistics.at(stamp)->total_pixels_with_depth,
            outputs_.statistics.at(stamp)->pixels_with_depth);
  EXPECT_NEAR(outputs_.pose.at(stamp)->pose.position.y, 0.0, 1e-9);
}

TEST_F(ContractTest, SettingsChangeAtRunTimeAndBadOnesAreRefused) {
  Console console;
  dynamic_reconfigure::Reconfigure call;
  dynamic_reconfigure::DoubleParameter range;
  range.name = "min_range";
  range.value = 3.0;
  call.request.config.doubles.push_back(range);
  ASSERT_TRUE(ros::service::call("/fusion/set_parameters", call));
  const Stamp stamp = sendFrames(1);
  EXPECT_EQ(outputs_.statistics.at(stamp)->pixels_with_depth, 0U) << "the wall is 2 m away";

  call.request.config.doubles[0].value = 0.4;
  ASSERT_TRUE(ros::service::call("/fusion/set_parameters", call));
  EXPECT_GT(outputs_.statistics.at(sendFrames(1, 1))->pixels_with_depth, 0U);

  dynamic_reconfigure::Reconfigure bad;
  dynamic_reconfigure::StrParameter estimator;
  estimator.name = "scale_estimator";
  estimator.value = "astrology";
  bad.request.config.strs.push_back(estimator);
  EXPECT_TRUE(spinUntil([&] {  // until this node has heard of the other's console, too
    return ros::service::call("/fusion/set_parameters", bad) &&
           console.count({"refused", "scale_estimator", "mean_ratio, least_squares or weighted_robust"}) > 0;
  }));
  std::map<std::string, std::string> shown;
  for (const auto& parameter : bad.response.config.strs) shown[parameter.name] = parameter.value;
  EXPECT_EQ(shown["scale_estimator"], "weighted_robust");
  sendFrames(2, 2);

  // NaN is in no range, but passes the server's own limits.
  dynamic_reconfigure::Reconfigure no_number;
  no_number.request.config.doubles = {range};
  no_number.request.config.doubles[0].value = std::numeric_limits<double>::quiet_NaN();
  for (const char* server : {"/fusion/set_parameters", "/tracker/set_parameters"}) {
    ASSERT_TRUE(ros::service::call(server, no_number));
    std::map<std::string, double> numbers;
    for (const auto& parameter : no_number.response.config.doubles) numbers[parameter.name] = parameter.value;
    EXPECT_NEAR(numbers["min_range"], 0.4, 1e-6) << server;
  }
  EXPECT_GT(outputs_.statistics.at(sendFrames(1, 4))->pixels_with_depth, 0U);
}

TEST_F(ContractTest, DiagnosticsTellRateDelayStateScaleAndShares) {
  std::set<std::string> keys, names;
  int frame = 0;
  EXPECT_TRUE(spinUntil([&] {
    sendFrames(1, frame++);
    for (const auto& array : outputs_.diagnostics.messages) {
      for (const auto& status : array->status) {
        names.insert(status.name);
        for (const auto& value : status.values) keys.insert(value.key);
      }
    }
    return keys.count("state") > 0 && keys.count("scale") > 0;
  }));
  EXPECT_TRUE(names.count("tracker: tracking") == 1 && names.count("fusion: fusion") == 1)
      << ::testing::PrintToString(names);
  for (const char* key : {"rate [Hz]", "delay [s]", "state", "scale", "share fused"}) {
    EXPECT_EQ(keys.count(key), 1U) << key;
  }
}

TEST_F(ContractTest, EachNodeHasItsOwnParametersOnly) {
  ros::NodeHandle handle;
  EXPECT_TRUE(handle.hasParam("/tracker/keyframe_distance"));
  EXPECT_FALSE(handle.hasParam("/tracker/rim_width"));
  EXPECT_TRUE(handle.hasParam("/fusion/rim_width"));
  EXPECT_FALSE(handle.hasParam("/fusion/keyframe_distance"));
  for (const char* node : {"/tracker/", "/fusion/"})
    EXPECT_TRUE(handle.hasParam(node + std::string("max_range")));
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "contract_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
