// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Clouds as text: XYZ, CSV, TXT. A point per line; columns separated by spaces, tabs, commas or semicolons.
#ifndef CURVEREG_FILES_TEXT_FILE_H_
#define CURVEREG_FILES_TEXT_FILE_H_

#include <string_view>

#include "absl/status/statusor.h"
#include "files/atomic_file.h"
#include "files/cloud_file.h"

namespace curvereg {

// True when the first 4096 bytes hold no control characters but tabs and line ends. `only_ascii`: nor bytes above 126,
// for content that may as well be binary.
bool LooksLikeText(std::string_view bytes, bool only_ascii);

// The points of a text file that is in memory; x, y, z are the first three columns, or those that a header line names
// x, y, z. Lines that start with '#' or "//" are comments, further columns are ignored, an empty column of a CSV is no
// number (NaN), and a first line that holds just the number of lines is skipped.
// INVALID_ARGUMENT names the line that is not numbers; RESOURCE_EXHAUSTED as ReadCloudFile.
absl::StatusOr<Scan> ParseTextCloud(std::string_view bytes, const CloudReadOptions& options);

// Appends the scan after a header: "x,y,z" and commas when `is_csv`, else "# x y z" and spaces.
void AppendTextCloud(const Scan& scan, bool is_csv, AtomicFile& file);

}  // namespace curvereg

#endif  // CURVEREG_FILES_TEXT_FILE_H_
