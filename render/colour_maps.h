// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Colours for values. Each map rises evenly in lightness or in saturation and is readable with any colour vision.
#ifndef CURVEREG_RENDER_COLOUR_MAPS_H_
#define CURVEREG_RENDER_COLOUR_MAPS_H_

#include <array>
#include <cstdint>

namespace curvereg {

using Rgb = std::array<uint8_t, 3>;

// For signs and pairs: red-orange and blue of the palette of M. Okabe and K. Ito, "Color Universal Design", 2008.
inline constexpr Rgb kVermilion = {213, 94, 0};
inline constexpr Rgb kBlue = {0, 114, 178};

// A colour for `share` in [0, 1] (clamped; NaN counts as 0): OpenCV's VIRIDIS, from dark violet over green to yellow.
Rgb HeightColour(double share);

// A colour for `value` in [-1, 1] (clamped; NaN counts as 0): blue below 0, white at 0, red above.
Rgb SignedColour(double value);

// A grey for `share` in [0, 1] (clamped; NaN counts as 0): from black to white.
Rgb GreyColour(double share);

// A grey as GreyColour, from dark to light, on which every other colour shows.
Rgb BackgroundColour(double share);

}  // namespace curvereg

#endif  // CURVEREG_RENDER_COLOUR_MAPS_H_
