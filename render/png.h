// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// PNG pictures in memory: 8-bit grey and RGB, and colour maps for values.
#ifndef CURVEREG_RENDER_PNG_H_
#define CURVEREG_RENDER_PNG_H_

#include <array>
#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/image.h"

namespace curvereg {

using Rgb = std::array<uint8_t, 3>;

// The bytes of a PNG file. Deterministic. INVALID_ARGUMENT: the image is empty. INTERNAL: libpng's own message.
absl::StatusOr<std::string> EncodePng(const Image<uint8_t>& grey);
absl::StatusOr<std::string> EncodePng(const Image<Rgb>& picture);

// A colour for `share` in [0, 1] (clamped; NaN counts as 0): from dark blue over green to yellow with evenly rising
// lightness, so that it reads the same in grey and with any colour vision.
Rgb HeightColour(double share);

// A colour for `value` in [-1, 1] (clamped; NaN counts as 0): blue below 0, white at 0, red above.
Rgb SignedColour(double value);

}  // namespace curvereg

#endif  // CURVEREG_RENDER_PNG_H_
