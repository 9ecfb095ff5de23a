// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// PCD v0.7 (also .5, .6, .7 without the leading zero), the Point Cloud Library's format: ascii, binary and
// binary_compressed. x, y, z may be float or double and stand anywhere; other fields of any type and COUNT are skipped.
// VIEWPOINT is ignored: points stay in the frame the file has them in.
#ifndef CURVEREG_FILES_PCD_FILE_H_
#define CURVEREG_FILES_PCD_FILE_H_

#include <string_view>

#include "absl/status/statusor.h"
#include "files/atomic_file.h"
#include "files/cloud_file.h"

namespace curvereg {

// True when `bytes` begins as a PCD file does: "# .PCD", or VERSION or FIELDS after comments.
bool LooksLikePcd(std::string_view bytes);

// The points of a PCD file that is in memory. Errors as ReadCloudFile, without the file's name. A file that holds more
// points than its header says is as corrupt as one that holds fewer; zero bytes at the end are padding.
absl::StatusOr<Scan> ParsePcd(std::string_view bytes, const CloudReadOptions& options);

// Appends the scan as PCD v0.7 with fields x y z, float32; ascii has the shortest digits that read back exactly.
void AppendPcd(const Scan& scan, CloudEncoding encoding, AtomicFile& file);

}  // namespace curvereg

#endif  // CURVEREG_FILES_PCD_FILE_H_
