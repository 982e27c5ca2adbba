// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/preview/preview.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "canvas.h"
#include "rgbd_sfm_fusion/preview/colour_scale.h"
#include "rgbd_sfm_fusion/preview/preview_text.h"
#include "rgbd_sfm_fusion/preview/source_colours.h"

namespace rgbd_sfm_fusion {
namespace {

using Layout = PreviewLayout;
using Align = Canvas::Align;

// [px] Header, two rows of three panels, each with a caption above and room for a colour bar on its right,
// and a footer.
constexpr int kMargin = 14, kHeader = 50, kCaption = 30;
constexpr int kPanelWidth = 328, kPanelHeight = 246;
constexpr int kColumn = 419, kRow = kCaption + kPanelHeight + 10;
constexpr int kBarGap = 6, kBarWidth = 14, kLabelGap = 6;
constexpr int kFooter = kHeader + 2 * kRow;

// At half the size capitals are still 7 px high.
constexpr Canvas::Font kSmall{0.58, 1}, kNormal{0.66, 1}, kLarge{0.8, 2};

constexpr double kDark = 10.0;  // mean brightness, of 255

// RGB
const cv::Scalar kBackground(38, 40, 46), kPanelColour(24, 25, 29), kLine(110, 112, 120),
    kText(240, 240, 240);
const cv::Scalar kBlack(0, 0, 0), kGreen(80, 200, 110), kAmber(250, 190, 70), kRed(255, 105, 95);

cv::Scalar toScalar(const cv::Vec3b& rgb) {
  return {static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])};
}

cv::Scalar colourOf(PreviewMood mood) {
  return mood == PreviewMood::kGood ? kGreen : mood == PreviewMood::kWaiting ? kAmber : kRed;
}

/// @return where the image goes
cv::Mat openPanel(Canvas& canvas, Layout::Panel panel, cv::Size size) {
  canvas.fill(Layout::panel(panel), kPanelColour);
  canvas.frame(Layout::panel(panel), kLine);
  return size.empty() ? cv::Mat() : canvas.image()(Layout::imageIn(panel, size));
}

void drawPicture(Canvas& canvas, const cv::Mat& picture) {
  cv::Mat place = openPanel(canvas, Layout::kPicture, picture.size());
  if (picture.empty()) return;
  cv::Mat fitted;
  cv::resize(picture, fitted, place.size(), 0.0, 0.0, cv::INTER_AREA);
  if (fitted.channels() == 1) cv::cvtColor(fitted, fitted, cv::COLOR_GRAY2RGB);
  fitted.copyTo(place);
}

/// Picks pixels instead of averaging them: a mixture of two colours would mean something else.
template <class Pixel, class Paint>
void drawValues(Canvas& canvas, Layout::Panel panel, const cv::Mat_<Pixel>& values, Paint paint) {
  cv::Mat place = openPanel(canvas, panel, values.size());
  if (values.empty()) return;
  cv::Mat_<Pixel> fitted;
  cv::resize(values, fitted, place.size(), 0.0, 0.0, cv::INTER_NEAREST);
  cv::Mat(paint(fitted)).copyTo(place);
}

void drawScaled(Canvas& canvas, Layout::Panel panel, const cv::Mat_<float>& values,
                const ColourScale& scale) {
  drawValues(canvas, panel, values, [&](const cv::Mat_<float>& fitted) { return scale.paint(fitted); });
}

void drawCaption(Canvas& canvas, Layout::Panel panel, const std::string& title, const std::string& figure) {
  const cv::Rect area = Layout::panel(panel);
  const int y = area.y - kCaption / 2;
  canvas.text(title, {area.x, y}, Align::kLeft, kNormal, kText);
  canvas.text(figure, {area.br().x, y}, Align::kRight, kNormal, kText);
}

void drawNotice(Canvas& canvas, Layout::Panel panel, const std::string& words) {
  const cv::Rect area = Layout::panel(panel);
  canvas.text(words, {area.x + area.width / 2, area.y + area.height / 2}, Align::kCentre, kNormal, kText);
}

/// Beside a panel, the smallest value at the bottom.
void drawBar(Canvas& canvas, Layout::Panel panel, const ColourScale& scale) {
  const cv::Rect area = Layout::panel(panel);
  const cv::Rect bar(area.br().x + kBarGap, area.y, kBarWidth, area.height);
  const double log_first = std::log(scale.ticks().front().value),
               log_last = std::log(scale.ticks().back().value);
  for (int i = 0; i < bar.height; ++i) {
    const double share = 1.0 - static_cast<double>(i) / (bar.height - 1);
    const auto value = static_cast<float>(std::exp(log_first + share * (log_last - log_first)));
    canvas.fill({bar.x, bar.y + i, bar.width, 1}, toScalar(scale.colour(value)));
  }
  canvas.frame(bar, kLine);
  for (const ColourScale::Tick& tick : scale.ticks()) {
    const int y = bar.y + static_cast<int>(std::lround((1.0 - scale.place(tick.value)) * (bar.height - 1)));
    canvas.fill({bar.br().x - 4, y, 8, 1}, kText);
    canvas.text(tick.label, {bar.br().x + kLabelGap, std::clamp(y, bar.y + 7, bar.br().y - 8)}, Align::kLeft,
                kSmall, kText);
  }
}

void drawHeader(Canvas& canvas, const PreviewFrame& frame) {
  const PreviewState state = describeState(frame);
  const cv::Rect badge(kMargin, 8, Canvas::width(state.text, kLarge) + 28, kHeader - 14);
  const int y = badge.y + badge.height / 2;
  canvas.fill(badge, colourOf(state.mood));
  canvas.text(state.text, {badge.x + badge.width / 2, y}, Align::kCentre, kLarge, kBlack);
  canvas.text(speedText(frame), {Layout::kWidth - kMargin, y}, Align::kRight, kLarge, kText);
}

void drawPanels(Canvas& canvas, const PreviewFrame& frame, const PreviewShares& shares) {
  const ColourScale &depth = ColourScale::depth(), &deviation = ColourScale::standardDeviation();
  cv::Mat_<float> sigma;
  cv::sqrt(frame.fused.depth.variance, sigma);

  drawPicture(canvas, frame.picture);
  drawScaled(canvas, Layout::kSensor, frame.sensor, depth);
  drawScaled(canvas, Layout::kSfm, frame.fused.sfm.mean, depth);
  drawScaled(canvas, Layout::kFused, frame.fused.depth.mean, depth);
  drawValues(canvas, Layout::kSource, frame.fused.provenance, paintSources);
  drawScaled(canvas, Layout::kStandardDeviation, sigma, deviation);

  drawCaption(canvas, Layout::kPicture, "camera image", "");
  drawCaption(canvas, Layout::kSensor, "sensor depth", percentText(shares.sensor));
  drawCaption(canvas, Layout::kSfm, "from motion (SfM)", percentText(shares.sfm));
  drawCaption(canvas, Layout::kFused, "fused depth", percentText(shares.fused()));
  drawCaption(canvas, Layout::kSource, "source of each pixel", "");
  drawCaption(canvas, Layout::kStandardDeviation, "how sure: standard deviation", "");
  for (const Layout::Panel panel : {Layout::kSensor, Layout::kSfm, Layout::kFused})
    drawBar(canvas, panel, depth);
  drawBar(canvas, Layout::kStandardDeviation, deviation);

  if (frame.picture.empty()) {
    drawNotice(canvas, Layout::kPicture, "no image");
  } else if (cv::mean(frame.picture)[0] < kDark) {
    drawNotice(canvas, Layout::kPicture, "the image is dark");
  }
  if (frame.sensor.empty()) {
    drawNotice(canvas, Layout::kSensor, "no depth image");
  } else if (shares.sensor <= 0.0) {
    drawNotice(canvas, Layout::kSensor, "nothing measured");
  }
  if (shares.sfm <= 0.0) drawNotice(canvas, Layout::kSfm, "none in this frame");
  if (shares.fused() <= 0.0) drawNotice(canvas, Layout::kFused, "no depth at all");
}

/// A bar of the shares, and below it what its colours mean.
void drawLegend(Canvas& canvas, const PreviewShares& shares) {
  const cv::Rect bar(kMargin, kFooter + 8, Layout::kWidth - 2 * kMargin, 16);
  const std::array<std::size_t, 5> order = {1, 3, 2, 4, 0};
  double from = 0.0;
  int x = bar.x;
  for (const std::size_t source : order) {
    const SourceColour& colour = sourceColours()[source];
    const double to = from + shares.by_source[source];
    const auto left = static_cast<int>(std::lround(from * bar.width)),
               right = static_cast<int>(std::lround(std::min(to, 1.0) * bar.width));
    canvas.fill({bar.x + left, bar.y, right - left, bar.height}, toScalar(colour.rgb));
    from = to;

    const cv::Rect box(x, bar.br().y + 12, 18, 18);
    canvas.fill(box, toScalar(colour.rgb));
    canvas.frame(box, kLine);
    const std::string words = std::string(colour.name) + " " + percentText(shares.by_source[source]);
    canvas.text(words, {box.br().x + 8, box.y + box.height / 2}, Align::kLeft, kNormal, kText);
    x = box.br().x + 8 + Canvas::width(words, kNormal) + 26;
  }
  canvas.frame(bar, kLine);
}

void drawFooter(Canvas& canvas, const PreviewFrame& frame, const PreviewShares& shares) {
  drawLegend(canvas, shares);
  const int y = Layout::kHeight - 19;
  canvas.text(refilledText(shares), {kMargin, y}, Align::kLeft, kNormal, kText);
  canvas.text(scaleText(frame.fused.scale), {Layout::kWidth - kMargin, y}, Align::kRight, kNormal, kText);
}

}  // namespace

cv::Rect PreviewLayout::panel(Panel panel) {
  const int column = panel % 3, row = panel / 3;
  return {kMargin + column * kColumn, kHeader + kCaption + row * kRow, kPanelWidth, kPanelHeight};
}

cv::Rect PreviewLayout::imageIn(Panel panel, cv::Size size) {
  const cv::Rect area = PreviewLayout::panel(panel);
  const double scale =
      std::min(static_cast<double>(area.width) / size.width, static_cast<double>(area.height) / size.height);
  const cv::Size fitted(std::max(1, static_cast<int>(std::lround(scale * size.width))),
                        std::max(1, static_cast<int>(std::lround(scale * size.height))));
  return {area.tl() + cv::Point(area.width - fitted.width, area.height - fitted.height) / 2, fitted};
}

cv::Mat_<cv::Vec3b> drawPreview(const PreviewFrame& frame) {
  const PreviewShares shares = sharesOf(frame);
  Canvas canvas({Layout::kWidth, Layout::kHeight}, kBackground);
  drawHeader(canvas, frame);
  drawPanels(canvas, frame, shares);
  drawFooter(canvas, frame, shares);
  return canvas.image();
}

}  // namespace rgbd_sfm_fusion
