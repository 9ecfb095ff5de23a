// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace curvereg {
namespace {

// OpenCV's drawing takes points in integers with this many binary digits of fraction.
constexpr int kShift = 4;

cv::Point Fixed(const PixelPoint& point) {
  return {static_cast<int>(std::lround(std::ldexp(point.x, kShift))),
          static_cast<int>(std::lround(std::ldexp(point.y, kShift)))};
}

int Fixed(double length_px) { return static_cast<int>(std::lround(std::ldexp(length_px, kShift))); }

// OpenCV's view of the picture, without a copy. Its functions take any order of channels: ours is red, green, blue.
cv::Mat MatOf(Image<Rgb>& picture) { return {picture.rows, picture.cols, CV_8UC3, picture.pixels.data()}; }

const cv::Mat MatOf(const Image<Rgb>& picture) {
  return {picture.rows, picture.cols, CV_8UC3, const_cast<Rgb*>(picture.pixels.data())};
}

cv::Scalar ScalarOf(const Rgb& colour) { return cv::Scalar(colour[0], colour[1], colour[2]); }

constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;

constexpr int kStroke = 1;

double ScaleOf(const TextStyle& style) { return cv::getFontScaleFromHeight(kFont, style.height_px, kStroke); }

}  // namespace

int TextWidth(const std::string& text, const TextStyle& style) {
  int below_baseline = 0;
  return cv::getTextSize(text, kFont, ScaleOf(style), kStroke, &below_baseline).width;
}

void Canvas::Line(const PixelPoint& from, const PixelPoint& to, const Rgb& colour, int width_px) {
  cv::Mat mat = MatOf(picture_);
  cv::line(mat, Fixed(from), Fixed(to), ScalarOf(colour), width_px, cv::LINE_AA, kShift);
}

void Canvas::Arrow(const PixelPoint& from, const PixelPoint& to, const Rgb& colour, int width_px) {
  cv::Mat mat = MatOf(picture_);
  cv::arrowedLine(mat, Fixed(from), Fixed(to), ScalarOf(colour), width_px, cv::LINE_AA, kShift, 0.3);
}

void Canvas::Circle(const PixelPoint& centre, double radius_px, const Rgb& colour, int width_px) {
  cv::Mat mat = MatOf(picture_);
  const int line_type = width_px == 1 ? cv::LINE_8 : cv::LINE_AA;
  cv::circle(mat, Fixed(centre), Fixed(radius_px), ScalarOf(colour), width_px, line_type, kShift);
}

void Canvas::Disc(const PixelPoint& centre, double radius_px, const Rgb& colour) {
  Circle(centre, radius_px, colour, cv::FILLED);
}

void Canvas::Fill(const PixelRect& area, const Rgb& colour) {
  cv::Mat mat = MatOf(picture_);
  cv::rectangle(mat, cv::Rect(area.left, area.top, area.width, area.height), ScalarOf(colour), cv::FILLED);
}

void Canvas::Outline(const PixelRect& area, const Rgb& colour) {
  cv::Mat mat = MatOf(picture_);
  cv::rectangle(mat, cv::Rect(area.left, area.top, area.width, area.height), ScalarOf(colour), 1, cv::LINE_8);
}

void Canvas::Text(const PixelPoint& at, TextAnchor anchor, const std::string& text, const TextStyle& style,
                  const Rgb& colour) {
  // Written onto a strip of ink first, which can be turned, then mixed into the picture.
  const int width = TextWidth(text, style);
  const int margin = style.height_px;  // what hangs below the line, and the antialiasing
  cv::Mat ink = cv::Mat::zeros(style.height_px + 2 * margin, width + 2 * margin, CV_8U);
  cv::putText(ink, text, cv::Point(margin, margin + style.height_px), kFont, ScaleOf(style), cv::Scalar(255), kStroke,
              cv::LINE_AA);
  if (style.is_upward) cv::rotate(ink, ink, cv::ROTATE_90_COUNTERCLOCKWISE);
  const double share = anchor == TextAnchor::kBegin ? 0.0 : anchor == TextAnchor::kMiddle ? 0.5 : 1.0;
  const double along = margin + share * width;
  const double across = margin + 0.5 * style.height_px;
  const int left = static_cast<int>(std::lround(at.x - (style.is_upward ? across : along)));
  const int top = static_cast<int>(std::lround(at.y - (style.is_upward ? ink.rows - along : across)));
  for (int row = std::max(0, -top); row < std::min(ink.rows, picture_.rows - top); ++row) {
    for (int col = std::max(0, -left); col < std::min(ink.cols, picture_.cols - left); ++col) {
      const double share_of_ink = ink.at<uint8_t>(row, col) / 255.0;
      Rgb& pixel = picture_(top + row, left + col);
      for (size_t c = 0; c < 3; ++c) {
        pixel[c] = static_cast<uint8_t>(std::lround(std::lerp(pixel[c], colour[c], share_of_ink)));
      }
    }
  }
}

void Canvas::Paste(const Image<Rgb>& picture, int left, int top) {
  if (picture.empty()) return;
  MatOf(picture).copyTo(MatOf(picture_)(cv::Rect(left, top, picture.cols, picture.rows)));
}

// cv::repeat, with rows and pixels made into rows of a matrix by turns: cv::resize would start threads of its own.
Image<Rgb> Zoomed(const Image<Rgb>& picture, int zoom) {
  Image<Rgb> zoomed(picture.rows * zoom, picture.cols * zoom);
  if (zoomed.empty()) return zoomed;
  const cv::Mat wide = cv::repeat(MatOf(picture).reshape(3, picture.rows * picture.cols), 1, zoom);
  cv::Mat out = MatOf(zoomed).reshape(3, picture.rows);
  cv::repeat(wide.reshape(3, picture.rows), 1, zoom, out);
  return zoomed;
}

Image<Rgb> FlippedRows(const Image<Rgb>& picture) {
  Image<Rgb> flipped(picture.rows, picture.cols);
  if (flipped.empty()) return flipped;
  cv::Mat out = MatOf(flipped);
  cv::flip(MatOf(picture), out, 0);
  return flipped;
}

}  // namespace curvereg
