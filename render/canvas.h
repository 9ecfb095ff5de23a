// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Drawing on a picture in memory, by OpenCV: anti-aliased lines, arrows, circles and text. The same bytes on every
// machine.
#ifndef CURVEREG_RENDER_CANVAS_H_
#define CURVEREG_RENDER_CANVAS_H_

#include <string>

#include "core/base/image.h"
#include "render/colour_maps.h"

namespace curvereg {

// x to the right and y downwards [px]; the centre of the upper left pixel is (0, 0).
struct PixelPoint {
  double x = 0.0;
  double y = 0.0;
};

struct PixelRect {
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
};

struct TextStyle {
  int height_px = 14;      // of a capital letter
  bool is_upward = false;  // written from below to above
};

// Which point of the text is given: its beginning, middle or end along the line; across it always the middle of a
// capital letter.
enum class TextAnchor { kBegin, kMiddle, kEnd };

// Width of a line of text [px].
int TextWidth(const std::string& text, const TextStyle& style);

// What lies outside the picture is cut off. The picture outlives the canvas.
class Canvas {
 public:
  explicit Canvas(Image<Rgb>& picture) : picture_(picture) {}

  void Line(const PixelPoint& from, const PixelPoint& to, const Rgb& colour, int width_px = 1);
  void Arrow(const PixelPoint& from, const PixelPoint& to, const Rgb& colour, int width_px = 1);
  // Anti-aliased from a width of 2 on: OpenCV spreads a width of 1 over three pixels, which fills small circles.
  void Circle(const PixelPoint& centre, double radius_px, const Rgb& colour, int width_px = 1);
  void Disc(const PixelPoint& centre, double radius_px, const Rgb& colour);
  void Fill(const PixelRect& area, const Rgb& colour);
  // One pixel wide, just inside of the area.
  void Outline(const PixelRect& area, const Rgb& colour);
  // Printable ASCII; any other byte is drawn as '?'.
  void Text(const PixelPoint& at, TextAnchor anchor, const std::string& text, const TextStyle& style,
            const Rgb& colour = {0, 0, 0});
  // The picture's upper left corner comes to (left, top). Precondition: it fits.
  void Paste(const Image<Rgb>& picture, int left, int top);

 private:
  Image<Rgb>& picture_;
};

// Each pixel as `zoom` x `zoom` pixels. Precondition: zoom >= 1.
Image<Rgb> Zoomed(const Image<Rgb>& picture, int zoom);

// The picture upside down: bird's-eye views count rows with y, pictures downwards.
Image<Rgb> FlippedRows(const Image<Rgb>& picture);

}  // namespace curvereg

#endif  // CURVEREG_RENDER_CANVAS_H_
