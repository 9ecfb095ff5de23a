// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// PLY 1.0, the Stanford triangle format: ascii, binary little and big endian. The vertices' x, y, z may have any number
// type and stand anywhere; other properties and elements, lists too, are skipped.
#ifndef CURVEREG_FILES_PLY_FILE_H_
#define CURVEREG_FILES_PLY_FILE_H_

#include <string_view>

#include "absl/status/statusor.h"
#include "files/atomic_file.h"
#include "files/cloud_file.h"

namespace curvereg {

// True when `bytes` begins with the line "ply".
bool LooksLikePly(std::string_view bytes);

// The vertices of a PLY file that is in memory. Errors as ReadCloudFile, without the file's name. What follows the
// vertices is not looked at.
absl::StatusOr<Scan> ParsePly(std::string_view bytes, const CloudReadOptions& options);

// Appends the scan as PLY with float properties x y z, binary little endian or ascii.
void AppendPly(const Scan& scan, CloudEncoding encoding, AtomicFile& file);

}  // namespace curvereg

#endif  // CURVEREG_FILES_PLY_FILE_H_
