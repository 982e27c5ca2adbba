// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/epipolar_stereo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "rgbd_sfm_fusion/mapping/semi_dense_mapper.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

/// All pixels once, from top to bottom.
std::vector<int> pixelsOf(const StereoCandidates& candidates) {
  std::vector<int> pixels;
  for (const auto& band : candidates.bands()) {
    for (const StereoCandidates::Block& block : band)
      pixels.insert(pixels.end(), std::begin(block.pixel), std::end(block.pixel));
  }
  pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
  return pixels;
}

class EpipolarStereoTest : public testing::Test {
 protected:
  EpipolarStereoTest() {
    const cv::Size size(scene_.camera().width, scene_.camera().height);
    none_.create(size);
    none_.clear();
    options_.min_gradient = 5.0F;
    options_.image_noise = 3.0F;
    options_.epipolar_noise = 0.05F;
  }

  GreyImage noisyImage(const SE3& T, std::uint64_t seed) const { return scene_.frame(1, T, 3.0, seed).grey; }

  std::vector<StereoObservation> observe(const SE3& T, const InverseDepthImage& prior,
                                         double max_inverse_depth, const Brightness& brightness = {}) {
    GreyImage view;
    noisyImage(T, 12).convertTo(view, CV_8U, brightness.gain, brightness.offset);
    return observe(T, view, prior, max_inverse_depth, brightness);
  }

  std::vector<StereoObservation> observe(const SE3& T, const GreyImage& view, const InverseDepthImage& prior,
                                         double max_inverse_depth, const Brightness& brightness = {}) {
    const GreyImage keyframe = noisyImage(SE3(), 11);
    const StereoCandidates candidates = candidatesOf(keyframe);
    return EpipolarStereo(scene_.camera())
        .observe(keyframe, {candidates, candidates, {}}, {&view, all_, T, brightness},
                 {none_, never_, prior, static_cast<float>(max_inverse_depth)}, options_);
  }

  StereoCandidates candidatesOf(const GreyImage& keyframe) const {
    cv::Mat_<float> image;
    keyframe.convertTo(image, CV_32F);
    StereoCandidates candidates;
    candidates.collect(image, all_, options_.min_gradient);
    return candidates;
  }

  double trueInverseDepth(int pixel) const {
    return 1.0 / scene_.depth(SE3(), pixel % scene_.camera().width, pixel / scene_.camera().width);
  }

  PlaneScene scene_{smallCamera()};
  InverseDepthImage none_;
  const cv::Mat_<std::uint8_t> never_ = cv::Mat_<std::uint8_t>(240, 320, std::uint8_t{0});
  const cv::Rect all_{0, 0, scene_.camera().width, scene_.camera().height};
  MappingOptions options_;
};

/// Median error over the true inverse depth, and mean squared error over the stated variance, capped at 25.
struct Quality {
  std::size_t matched = 0;
  double median = 1.0, nees = 1e9;
};

template <typename Truth>
Quality judge(const std::vector<StereoObservation>& observations, const Truth& truth) {
  std::vector<double> relative;
  double nees = 0.0;
  for (const StereoObservation& o : observations) {
    if (!o.matched) continue;
    const double error = static_cast<double>(o.inverse_depth) - truth(o.pixel);
    relative.push_back(std::abs(error) / truth(o.pixel));
    nees += std::min(error * error / static_cast<double>(o.variance), 25.0);
  }
  if (relative.empty()) return {};
  std::nth_element(relative.begin(), relative.begin() + static_cast<long>(relative.size() / 2),
                   relative.end());
  return {relative.size(), relative[relative.size() / 2], nees / static_cast<double>(relative.size())};
}

TEST_F(EpipolarStereoTest, FindsDepthWithoutPriorAndKnowsItsError) {
  for (const SE3& T : {motion(0.06, 0, 0), motion(-0.05, 0.03, 0),
                       motion(0.05, 0.02, 0.03, 0.01, -0.02, 0.03), motion(0, 0.06, -0.02, 0, 0, -0.05)}) {
    const Quality quality =
        judge(observe(T, none_, 1.5), [this](int pixel) { return trueInverseDepth(pixel); });
    EXPECT_GT(quality.matched, 3000U) << T.log().transpose();
    EXPECT_LT(quality.median, 0.053) << T.log().transpose();
    EXPECT_GT(quality.nees, 0.3) << T.log().transpose();
    EXPECT_LT(quality.nees, 2.5) << T.log().transpose();
  }
}

TEST_F(EpipolarStereoTest, AccountsForBrightness) {
  const Quality quality = judge(observe(motion(0.06, 0, 0), none_, 1.5, {0.7, 30.0}),
                                [this](int pixel) { return trueInverseDepth(pixel); });
  EXPECT_GT(quality.matched, 3000U);
  EXPECT_LT(quality.median, 0.05);
}

/// Of a third of the view nothing is left but white.
TEST_F(EpipolarStereoTest, FindsAlsoWhatIsPartlyTooBright) {
  const Brightness brightness{1.7, 20.0};
  const SE3 T = motion(0.06, 0, 0);
  const Quality quality =
      judge(observe(T, none_, 1.5, brightness), [this](int pixel) { return trueInverseDepth(pixel); });
  EXPECT_GT(quality.matched, 2400U);
  EXPECT_LT(quality.median, 0.05);
}

/// Light, vignetting and reflections make patches brighter or darker. A soft edge must then not be found
/// beside its place with a small variance.
TEST_F(EpipolarStereoTest, IsNotMovedByLightThatAPatchShares) {
  const SE3 T = motion(0.06, 0, 0);
  GreyImage view = noisyImage(T, 12);
  for (int v = 0; v < view.rows; ++v) {
    for (int u = 0; u < view.cols; ++u) {
      const double light = 4.0 * std::sin(0.05 * (u + v));
      view(v, u) = cv::saturate_cast<std::uint8_t>(view(v, u) + light);
    }
  }
  const Quality quality =
      judge(observe(T, view, none_, 1.5), [this](int pixel) { return trueInverseDepth(pixel); });
  EXPECT_GT(quality.matched, 3000U);
  EXPECT_LT(quality.median, 0.065);
  EXPECT_LT(quality.nees, 2.5);
}

TEST_F(EpipolarStereoTest, StaysWithinAPriorsReach) {
  InverseDepthImage prior;
  prior.create(none_.mean.size());
  prior.mean.setTo(0.5);
  prior.variance.setTo(0.05 * 0.05);
  int matched = 0;
  for (const StereoObservation& o : observe(motion(0.06, 0, 0), prior, 1.5)) {
    if (!o.matched) continue;
    ++matched;
    EXPECT_GT(o.inverse_depth, 0.3F);
    EXPECT_LT(o.inverse_depth, 0.7F);
  }
  EXPECT_GT(matched, 1000);
}

TEST_F(EpipolarStereoTest, FindsDepthOverLongSegmentsAlsoWhereTheyLeaveTheView) {
  for (const SE3& T : {motion(0.4, 0, 0), motion(-0.3, 0.2, 0), motion(0.1, 0.3, 0.05, 0, 0.05, 0.03)}) {
    const Quality quality =
        judge(observe(T, none_, 1.5), [this](int pixel) { return trueInverseDepth(pixel); });
    EXPECT_GT(quality.matched, 2000U) << T.log().transpose();
    EXPECT_LT(quality.median, 0.012) << T.log().transpose();
  }
}

TEST_F(EpipolarStereoTest, KnowsWhatAnErrorOfTheReadoutTimeDoes) {
  constexpr double kReadout = 0.03;
  Vector6 velocity, keyframe_velocity;
  velocity << 0.3, -0.2, 0.1, 0.05, 0.2, -0.1;
  keyframe_velocity << -0.3, 0.3, 0.0, -0.1, -0.2, 0.1;
  const SE3 T = motion(0.1, 0.02, 0.01, 0, 0.02, 0);
  GreyImage keyframe, view;
  scene_.image(SE3(), {kReadout * keyframe_velocity}).convertTo(keyframe, CV_8U);
  scene_.image(T, {kReadout * velocity}).convertTo(view, CV_8U);
  const StereoCandidates candidates = candidatesOf(keyframe);
  const auto truth = [&](int pixel) {
    const int u = pixel % scene_.camera().width, v = pixel / scene_.camera().width;
    const ReadoutMotion readout{kReadout * keyframe_velocity};
    return 1.0 / scene_.depth(readout.T_row_image(v, scene_.camera().height), u, v);
  };
  const auto observeWith = [&](double readout_time) {
    return EpipolarStereo(scene_.camera())
        .observe(keyframe, {candidates, candidates, {}},
                 {&view, all_, T, {}, readout_time, velocity, keyframe_velocity},
                 {none_, never_, none_, 1.5F}, options_);
  };
  std::vector<StereoObservation> observations = observeWith(0.0);
  const double ignored = judge(observations, truth).median,
               known = judge(observeWith(kReadout), truth).median;
  for (StereoObservation& o : observations) o.inverse_depth -= static_cast<float>(kReadout) * o.by_readout;
  const double corrected = judge(observations, truth).median;
  EXPECT_GT(ignored, 0.03);
  EXPECT_LT(known, 0.2 * ignored);
  EXPECT_LT(corrected, 0.3 * ignored) << ignored;
}

/// A turn that is taken for a move shifts the matches of a whole image. How much, pixels do not tell.
TEST_F(EpipolarStereoTest, AnErrorOfThePoseIsPartOfTheVariance) {
  const SE3 T = motion(0.06, 0, 0);
  const GreyImage keyframe = scene_.frame(1, SE3(), 1.0, 11).grey, view = scene_.frame(1, T, 1.0, 12).grey;
  options_.image_noise = 1.0F;
  const StereoCandidates candidates = candidatesOf(keyframe);
  std::vector<Vector6> errors(3, Vector6::Zero());
  errors[0] << 0.01, 0, 0, 0, -0.002, 0;
  errors[1] << 0, 0.004, 0, -0.002, 0, 0;
  errors[2] << 0, 0, 0.02, 0, 0, 0.01;
  for (const Vector6& error : errors) {
    const auto neesWith = [&](const Matrix6& covariance) {
      StereoView with_error{&view, all_, SE3::exp(error) * T, {}};
      with_error.covariance = covariance;
      EpipolarStereo stereo(scene_.camera());
      return judge(stereo.observe(keyframe, {candidates, candidates, {}}, with_error,
                                  {none_, never_, none_, 1.5F}, options_),
                   [this](int pixel) { return trueInverseDepth(pixel); })
          .nees;
    };
    EXPECT_GT(neesWith(Matrix6::Zero()), 4.0) << error.transpose();
    EXPECT_GT(neesWith(error * error.transpose()), 0.4) << error.transpose();
    EXPECT_LT(neesWith(error * error.transpose()), 2.5) << error.transpose();
  }
}

/// All views of a keyframe may be wrong in the same way, so that more of them do not make it smaller.
TEST_F(EpipolarStereoTest, ThePosesShareOfTheErrorStaysHoweverManyObservations) {
  const SE3 T = motion(0.06, 0, 0);
  options_.image_noise = 1.0F;
  ImagePyramid keyframe, image;
  keyframe.build(scene_.frame(1, SE3(), 1.0, 11).grey, 1);
  image.build(scene_.frame(2, T, 1.0, 12).grey, 1);
  StereoView view{&image.grey(), all_, T, {}};
  constexpr double kRelative = 0.05;  // error of the baseline, and so of each inverse depth
  view.covariance(0, 0) = std::pow(kRelative * T.translation().x(), 2);
  SemiDenseMapper mapper(scene_.camera());
  mapper.start(keyframe, options_);
  for (int i = 0; i < 10; ++i) mapper.observe(view, 1.5F, {}, options_);
  const SemiDenseMap& map = mapper.map();
  int count = 0;
  double relative = 0.0;
  for (int i = 0; i < static_cast<int>(map.observations.total()); ++i) {
    if (map.observations(i) < 2) continue;
    ++count;
    relative += static_cast<double>(map.by_pose(i) / map.estimate.mean(i));
  }
  ASSERT_GT(count, 500);
  // Two independent errors would leave 0.7 of one. At a first search, the middle of the segment may be nearer
  // than what is found.
  EXPECT_GT(relative, 0.95 * kRelative * count);
  EXPECT_LT(relative, 1.2 * kRelative * count);
}

TEST_F(EpipolarStereoTest, AnUnknownReadoutTimeIsPartOfTheVarianceHoweverManyObservations) {
  constexpr double kSigma = 0.015;  // [s]
  Vector6 velocity;
  velocity << 0.3, -0.2, 0.1, 0.05, 0.2, -0.1;
  const SE3 T = motion(0.1, 0.02, 0.01, 0, 0.02, 0);
  ImagePyramid keyframe, image;
  keyframe.build(scene_.frame(1, SE3(), 3.0, 11).grey, 1);
  image.build(scene_.frame(2, T, 3.0, 12).grey, 1);
  SemiDenseMapper mapper(scene_.camera());
  mapper.start(keyframe, options_);
  options_.smooth_published = false;
  const auto observeAgain = [&] {
    mapper.observe({&image.grey(), all_, T, {}, 0.0, velocity, Vector6::Zero()}, 1.5F, {}, options_);
  };
  /// The part of published depths' sigma that comes from the readout time.
  const auto sigmaOf = [&](double readout_sigma) {
    observeAgain();
    InverseDepthImage reliable;
    mapper.reliable({}, options_, reliable);
    GaussianDepth depth{cv::Mat_<float>(240, 320), cv::Mat_<float>(240, 320)}, exact = depth;
    exact.variance = depth.variance.clone();
    mapper.toDepth(reliable, {}, static_cast<float>(readout_sigma), options_, depth);
    mapper.toDepth(reliable, {}, 0.0F, options_, exact);
    return std::sqrt(cv::mean(depth.variance - exact.variance, reliable.mean > 0.0F)[0]);
  };
  observeAgain();
  const double once = sigmaOf(kSigma);
  EXPECT_GT(once, 0.01);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(sigmaOf(kSigma), once, 0.2 * once);
  EXPECT_EQ(sigmaOf(0.0), 0.0);
}

/// Most estimates are good already. The bound that tells has to be safe, and near what planning finds.
TEST_F(EpipolarStereoTest, IsPromisingWhereverItIsSearchedAndInFewOtherPlaces) {
  const StereoCandidates candidates = candidatesOf(noisyImage(SE3(), 11));
  const GreyImage view = noisyImage(SE3(), 12);
  cv::RNG random(5);
  InverseDepthImage estimate;
  estimate.create(none_.mean.size());
  random.fill(estimate.mean, cv::RNG::UNIFORM, 0.2, 1.4);
  random.fill(estimate.variance, cv::RNG::UNIFORM, -12.0, 0.0);
  cv::exp(estimate.variance, estimate.variance);
  estimate.variance.row(100).setTo(std::numeric_limits<float>::infinity());
  cv::Mat_<std::uint8_t> observations(none_.mean.size());
  random.fill(observations, cv::RNG::UNIFORM, 0, 4);
  const KnownDepths known{estimate, observations, estimate, 1.5F};
  const std::vector<SE3> usual = {motion(0.02, 0, 0), motion(-0.05, 0.03, 0), motion(0.002, 0.001, 0.1),
                                  motion(0.05, 0.02, 0.03, 0.01, -0.02, 0.3),
                                  motion(0, 0.06, -0.02, 0, 0.1, -0.05)};
  std::vector<StereoView> views;
  for (const SE3& T : usual) views.push_back({&view, all_, T, {}});
  for (const SE3& T : {usual[3], motion(0.3, 0, -0.4, 0, 0.2, 0), motion(0.1, 0, -0.8),
                       motion(0.05, 0, 0, 0, 0, 3.0), SE3()}) {
    views.push_back({&view, cv::Rect(20, 10, 250, 200), T, {}, 0.03});
    views.back().velocity << 0.3, -0.2, 0.1, 0.05, 0.2, -0.1;
    views.back().covariance.diagonal().setConstant(1e-6);
  }
  std::size_t all = 0, searched = 0, promising = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    EpipolarPlan plan(scene_.camera(), views[i], known, options_);
    for (std::size_t band = 0; band < candidates.bands().size(); ++band) {
      plan.setBand(band);
      for (const StereoCandidates::Block& block : candidates.bands()[band]) {
        bool marks[kLanes];
        plan.markPromising(block, marks);
        PlannedSegments planned;
        plan.plan(block, planned);
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
          const bool is_searched = planned.isSearched(lane);
          EXPECT_TRUE(marks[lane] || !is_searched) << i << " at " << block.pixel[lane];
          const bool is_padding = block.gradient_x[lane] == 0.0F && block.gradient_y[lane] == 0.0F;
          EXPECT_FALSE(marks[lane] && is_padding) << i;
          if (i < usual.size()) ++all, searched += is_searched ? 1U : 0U, promising += marks[lane] ? 1U : 0U;
        }
      }
    }
  }
  EXPECT_GT(searched, all / 10);
  EXPECT_LT(promising - searched, all / 5) << searched << " of " << all;
}

TEST_F(EpipolarStereoTest, FindsNothingWithoutParallax) {
  EXPECT_TRUE(observe(SE3(), none_, 1.5).empty());
  EXPECT_TRUE(observe(motion(0, 0, 0, 0.02, -0.03, 0.01), none_, 1.5).empty());
}

TEST_F(EpipolarStereoTest, LeavesEdgesAlongTheEpipolarLineAlone) {
  // Horizontal stripes tell nothing of a horizontal motion.
  GreyImage stripes(scene_.camera().height, scene_.camera().width);
  for (int v = 0; v < stripes.rows; ++v) stripes.row(v).setTo(v / 4 % 2 == 0 ? 60.0 : 180.0);
  const StereoCandidates candidates = candidatesOf(stripes);
  ASSERT_GT(pixelsOf(candidates).size(), 10000U);
  EXPECT_TRUE(EpipolarStereo(scene_.camera())
                  .observe(stripes, {candidates, candidates, {}}, {&stripes, all_, motion(0.06, 0, 0), {}},
                           {none_, never_, none_, 1.5F}, options_)
                  .empty());
}

TEST_F(EpipolarStereoTest, RefusesRepetitiveTexture) {
  // Stripes every 8 px fit at every eighth pixel of the search.
  GreyImage stripes(scene_.camera().height, scene_.camera().width);
  for (int u = 0; u < stripes.cols; ++u) {
    stripes.col(u).setTo(120.0 + 60.0 * std::sin(2.0 * CV_PI * u / 8.0));
  }
  const StereoCandidates candidates = candidatesOf(stripes);
  const auto observations =
      EpipolarStereo(scene_.camera())
          .observe(stripes, {candidates, candidates, {}}, {&stripes, all_, motion(0.08, 0, 0), {}},
                   {none_, never_, none_, 1.5F}, options_);
  ASSERT_FALSE(observations.empty());
  EXPECT_TRUE(
      std::none_of(observations.begin(), observations.end(), [](const auto& o) { return o.matched; }));
}

TEST_F(EpipolarStereoTest, SearchesForOpenCandidatesAloneWhereItIsNotTheirTurn) {
  const GreyImage keyframe = noisyImage(SE3(), 11), view = noisyImage(motion(0.06, 0, 0), 12);
  const StereoCandidates all = candidatesOf(keyframe);
  StereoCandidates open;
  open.collectFrom(all, {}, [](int pixel) { return pixel % 320 < 100; });
  const RowBands turn{1, 3};
  const auto observations = EpipolarStereo(scene_.camera())
                                .observe(keyframe, {all, open, turn}, {&view, all_, motion(0.06, 0, 0), {}},
                                         {none_, never_, none_, 1.5F}, options_);
  int in_turn = 0, others = 0;
  for (const StereoObservation& o : observations) {
    const bool is_turn = o.pixel / 320 / RowBands::kRows % 3 == 1;
    EXPECT_TRUE(is_turn || o.pixel % 320 < 100) << o.pixel;
    ++(is_turn ? in_turn : others);
  }
  EXPECT_GT(in_turn, 2000);
  EXPECT_GT(others, 1000);
}

TEST(SemiDenseMapperTurns, RenewAveragesInTheirBandsAndFindNewPixelsEverywhere) {
  const PlaneScene scene(smallCamera());
  const SE3 T = motion(0.06, 0, 0), farther = motion(0.12, 0, 0);
  ImagePyramid keyframe, image, farther_image;
  keyframe.build(scene.frame(1, SE3(), 3.0, 11).grey, 1);
  image.build(scene.frame(2, T, 3.0, 12).grey, 1);
  farther_image.build(scene.frame(3, farther, 3.0, 13).grey, 1);
  const MappingOptions options;
  SemiDenseMapper mapper(scene.camera());
  mapper.start(keyframe, options);
  const RowBands turn{0, 2}, others{1, 2};
  mapper.observe({&image.grey(), image.seen(0), T, {}}, 1.5F, turn, options);
  const cv::Rect not_its_turn(0, RowBands::kRows, 320, RowBands::kRows);
  EXPECT_GT(cv::countNonZero(mapper.map().observations(not_its_turn)), 300);
  const cv::Mat_<float> before = mapper.smoothed().mean.clone();
  mapper.observe({&farther_image.grey(), farther_image.seen(0), farther, {}}, 1.5F, turn, options);
  EXPECT_GT(cv::norm(before(cv::Rect(0, 0, 320, RowBands::kRows)),
                     mapper.smoothed().mean(cv::Rect(0, 0, 320, RowBands::kRows))),
            0.0);
  InverseDepthImage reliable;
  mapper.reliable({}, options, reliable);
  EXPECT_EQ(cv::countNonZero(reliable.mean(not_its_turn)), 0) << "no averages yet";
  mapper.observe({&farther_image.grey(), farther_image.seen(0), farther, {}}, 1.5F, others, options);
  mapper.reliable(others, options, reliable);
  EXPECT_GT(cv::countNonZero(reliable.mean(not_its_turn)), 300);
}

TEST(SemiDenseMapper, SearchesAgainWhereNeighboursContradictAMatch) {
  const PlaneScene scene(smallCamera());
  ImagePyramid keyframe;
  keyframe.build(scene.frame(1, SE3(), 10.0, 11).grey, 1);
  const MappingOptions options;
  SemiDenseMapper mapper(scene.camera());
  mapper.start(keyframe, options);
  for (int i = 1; i <= 6; ++i) {
    const SE3 T = motion(0.04 * i, 0, 0);
    ImagePyramid image;
    image.build(scene.frame(i + 1, T, 10.0, static_cast<std::uint64_t>(20 + i)).grey, 1);
    mapper.observe({&image.grey(), image.seen(0), T, {}}, 1.5F, {}, options);
  }
  InverseDepthImage reliable;
  mapper.reliable({}, options, reliable);
  const int seen = cv::countNonZero(mapper.map().observations >= 2),
            used = cv::countNonZero(reliable.mean > 0.0F);
  ASSERT_GT(seen, 20000);
  EXPECT_LT(seen - used, 0.348 * seen);  // 0.354, if wrong matches were looked for where they were found
}

}  // namespace
}  // namespace rgbd_sfm_fusion
