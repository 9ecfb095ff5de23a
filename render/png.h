// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// PNG pictures in memory: 8-bit grey and RGB.
#ifndef CURVEREG_RENDER_PNG_H_
#define CURVEREG_RENDER_PNG_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/image.h"
#include "render/colour_maps.h"

namespace curvereg {

// The bytes of a PNG file. Deterministic. INVALID_ARGUMENT: the image is empty. INTERNAL: libpng's own message.
absl::StatusOr<std::string> EncodePng(const Image<uint8_t>& grey);
absl::StatusOr<std::string> EncodePng(const Image<Rgb>& picture);

}  // namespace curvereg

#endif  // CURVEREG_RENDER_PNG_H_
