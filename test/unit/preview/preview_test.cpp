// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/preview/preview.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "preview_frames.h"
#include "rgbd_sfm_fusion/preview/colour_scale.h"
#include "rgbd_sfm_fusion/preview/preview_text.h"
#include "rgbd_sfm_fusion/preview/source_colours.h"

namespace rgbd_sfm_fusion {
namespace {

using Layout = PreviewLayout;
using Picture = cv::Mat_<cv::Vec3b>;

const std::vector<Layout::Panel> kPanels = {Layout::kPicture, Layout::kSensor, Layout::kSfm,
                                            Layout::kFused,   Layout::kSource, Layout::kStandardDeviation};
const cv::Rect kHeader(0, 0, Layout::kWidth, 48);
const cv::Rect kFooter(0, 654, Layout::kWidth, Layout::kHeight - 654);

/// The colour in the middle of a stripe of stripedFrame().
cv::Vec3b inStripe(const Picture& preview, Layout::Panel panel, cv::Size size, int stripe) {
  const cv::Rect area = Layout::imageIn(panel, size);
  return preview(area.y + area.height / 2, area.x + (2 * stripe + 1) * area.width / 10);
}

bool hasColour(const Picture& picture, const cv::Rect& area, const cv::Vec3b& colour) {
  const Picture part = picture(area);
  return std::any_of(part.begin(), part.end(), [&](const cv::Vec3b& pixel) { return pixel == colour; });
}

bool isEmpty(const Picture& picture, const cv::Rect& area) {
  const Picture part = picture(area);
  return std::all_of(part.begin(), part.end(), [&](const cv::Vec3b& pixel) { return pixel == part(0, 0); });
}

class PreviewOfSize : public ::testing::TestWithParam<cv::Size> {};

TEST_P(PreviewOfSize, EveryPanelShowsItsImageInItsColours) {
  const cv::Size size = GetParam();
  const Picture preview = drawPreview(stripedFrame(size));
  ASSERT_EQ(preview.size(), cv::Size(Layout::kWidth, Layout::kHeight));
  const cv::Vec3b black(0, 0, 0);
  const auto depth = [](float metres) { return ColourScale::depth().colour(metres); };
  const auto sigma = ColourScale::standardDeviation().colour(0.01F);
  for (int stripe = 0; stripe < 5; ++stripe) {
    const bool by_sensor = stripe == 1 || stripe == 3, by_sfm = stripe == 2 || stripe == 3;
    EXPECT_EQ(inStripe(preview, Layout::kPicture, size, stripe), cv::Vec3b(200, 100, 50));
    EXPECT_EQ(inStripe(preview, Layout::kSensor, size, stripe), by_sensor ? depth(2.0F) : black) << stripe;
    EXPECT_EQ(inStripe(preview, Layout::kSfm, size, stripe), by_sfm ? depth(5.0F) : black) << stripe;
    EXPECT_EQ(inStripe(preview, Layout::kFused, size, stripe), stripe > 0 ? depth(1.0F) : black) << stripe;
    EXPECT_EQ(inStripe(preview, Layout::kSource, size, stripe),
              sourceColour(static_cast<std::uint8_t>(stripe)));
    EXPECT_EQ(inStripe(preview, Layout::kStandardDeviation, size, stripe), stripe > 0 ? sigma : black);
  }
}

TEST_P(PreviewOfSize, SourcesAreNotMixed) {
  const cv::Size size = GetParam();
  PreviewFrame frame = stripedFrame(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) frame.fused.provenance(y, x) = (x + y) % 2 == 0 ? 0 : 4;
  const Picture panel = drawPreview(frame)(Layout::imageIn(Layout::kSource, size));
  for (const cv::Vec3b& pixel : panel) ASSERT_TRUE(pixel == sourceColour(0) || pixel == sourceColour(4));
}

TEST_P(PreviewOfSize, ImagesStayInTheirPanelsWithTheirAspect) {
  const cv::Size size = GetParam();
  for (const Layout::Panel panel : kPanels) {
    const cv::Rect image = Layout::imageIn(panel, size);
    EXPECT_EQ(image & Layout::panel(panel), image);
    EXPECT_NEAR(static_cast<double>(image.width) / image.height,
                static_cast<double>(size.width) / size.height, 0.02);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, PreviewOfSize,
                         ::testing::Values(cv::Size(640, 480), cv::Size(320, 240), cv::Size(1280, 960),
                                           cv::Size(648, 420), cv::Size(1280, 720), cv::Size(160, 120),
                                           cv::Size(480, 640)));

TEST(Preview, ShowsGreyImages) {
  PreviewFrame frame = stripedFrame({640, 480});
  frame.picture = cv::Mat(480, 640, CV_8UC1, cv::Scalar(77));
  EXPECT_EQ(inStripe(drawPreview(frame), Layout::kPicture, {640, 480}, 2), cv::Vec3b(77, 77, 77));
}

TEST(Preview, LegendHasAllColoursAndWords) {
  const Picture preview = drawPreview(stripedFrame({640, 480}));
  for (const SourceColour& colour : sourceColours())
    EXPECT_TRUE(hasColour(preview, kFooter, colour.rgb)) << colour.name;
  EXPECT_FALSE(isEmpty(preview, {40, 655, 100, 26})) << "name of the first source";
}

TEST(Preview, ColourBarsSpanTheirScales) {
  const Picture preview = drawPreview(stripedFrame({640, 480}));
  for (const Layout::Panel panel : kPanels) {
    const bool has_bar = panel != Layout::kPicture && panel != Layout::kSource;
    const cv::Rect area = Layout::panel(panel), beside(area.br().x + 7, area.y, 10, area.height);
    const ColourScale& scale =
        panel == Layout::kStandardDeviation ? ColourScale::standardDeviation() : ColourScale::depth();
    for (const ColourScale::Tick& tick : scale.ticks()) {
      const auto colour = scale.colour(static_cast<float>(tick.value));
      const bool is_end = &tick == &scale.ticks().front() || &tick == &scale.ticks().back();
      if (is_end || !has_bar) {
        EXPECT_EQ(hasColour(preview, beside, colour), has_bar) << panel << tick.label;
      }
    }
  }
}

TEST(Preview, StateChangesTheHeader) {
  PreviewFrame frame = stripedFrame({320, 240});
  const Picture tracking = drawPreview(frame)(kHeader).clone();
  frame.state = TrackingState::kLost;
  const Picture lost = drawPreview(frame)(kHeader).clone();
  EXPECT_GT(cv::norm(tracking, lost, cv::NORM_INF), 50.0);
  EXPECT_FALSE(isEmpty(lost, {0, 0, 300, 48}));
  EXPECT_FALSE(isEmpty(lost, {Layout::kWidth - 300, 0, 300, 48}));
}

/// Every text that a header, footer or caption may hold, in its widest form.
std::vector<PreviewFrame> wordyFrames() {
  std::vector<PreviewFrame> frames;
  for (int i = 0; i < 5; ++i) {
    PreviewFrame frame = stripedFrame({640, 480});
    frame.rate = 29.9;
    frame.latency = 12.345;
    if (i == 0) frame.state = TrackingState::kLost;
    if (i == 1) frame.state = TrackingState::kInitialising;
    if (i == 2) frame.fused.sfm_rejected = true;
    if (i == 3) frame.fused.scale = {};
    if (i == 4) frame.sensor.release(), frame.picture.release(), frame.fused.sfm = {};
    frames.push_back(frame);
  }
  return frames;
}

TEST(Preview, NoTextIsCutOffAtTheRim) {
  for (const PreviewFrame& frame : wordyFrames()) {
    const Picture preview = drawPreview(frame);
    for (const cv::Rect& rim : {cv::Rect(0, 0, Layout::kWidth, 3), cv::Rect(0, 0, 3, Layout::kHeight),
                                cv::Rect(Layout::kWidth - 6, 0, 6, Layout::kHeight),
                                cv::Rect(0, Layout::kHeight - 3, Layout::kWidth, 3)}) {
      EXPECT_TRUE(isEmpty(preview, rim)) << describeState(frame).text << rim;
    }
  }
}

TEST(Preview, WordsInALineAreApart) {
  for (const PreviewFrame& frame : wordyFrames()) {
    const Picture preview = drawPreview(frame);
    for (const cv::Rect& line : {cv::Rect(0, 2, Layout::kWidth, 46), cv::Rect(0, 690, Layout::kWidth, 28)}) {
      int gap = 0, widest = 0;
      for (int x = line.x + 20; x < line.br().x - 20; ++x) {
        gap = isEmpty(preview, {x, line.y, 1, line.height}) ? gap + 1 : 0;
        widest = std::max(widest, gap);
      }
      EXPECT_GE(widest, 24) << describeState(frame).text << line;
    }
  }
}

TEST(Preview, IsDrawnOfAFrameWithoutAnything) {
  PreviewFrame frame;
  frame.fused.depth = {cv::Mat_<float>(48, 64, NAN), cv::Mat_<float>(48, 64, NAN)};
  frame.fused.provenance = cv::Mat_<std::uint8_t>::zeros(48, 64);
  const Picture preview = drawPreview(frame);
  for (const Layout::Panel panel : {Layout::kPicture, Layout::kSensor, Layout::kSfm, Layout::kFused})
    EXPECT_FALSE(isEmpty(preview, Layout::panel(panel))) << panel << ": says that there is nothing";
}

TEST(Preview, SaysThatTheImageIsDark) {
  PreviewFrame frame = stripedFrame({640, 480});
  frame.picture.setTo(cv::Scalar(3, 3, 3));
  EXPECT_FALSE(isEmpty(drawPreview(frame), Layout::panel(Layout::kPicture)));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
