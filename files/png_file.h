// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Pictures as PNG files.
#ifndef CURVEREG_FILES_PNG_FILE_H_
#define CURVEREG_FILES_PNG_FILE_H_

#include <string>

#include "absl/status/status.h"
#include "core/base/image.h"
#include "render/png.h"

namespace curvereg {

// EncodePng to a file that appears whole or not at all.
absl::Status WritePngFile(const std::string& path, const Image<Rgb>& picture);

}  // namespace curvereg

#endif  // CURVEREG_FILES_PNG_FILE_H_
