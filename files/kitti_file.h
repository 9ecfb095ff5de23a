// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// KITTI .bin: four little-endian float32 per point, x y z reflectance, and nothing else.
#ifndef CURVEREG_FILES_KITTI_FILE_H_
#define CURVEREG_FILES_KITTI_FILE_H_

#include <string_view>

#include "absl/status/statusor.h"
#include "files/atomic_file.h"
#include "files/cloud_file.h"

namespace curvereg {

// The points of a KITTI file that is in memory. Errors as ReadCloudFile, without the file's name. The format has no
// mark of its own: bytes of which most are no coordinates in metres (beyond 1000 km, or nonzero below a nanometre) are
// refused with INVALID_ARGUMENT, a size that is not a multiple of 16 with DATA_LOSS.
absl::StatusOr<Scan> ParseKitti(std::string_view bytes, const CloudReadOptions& options);

// Appends the scan with reflectance 0.
void AppendKitti(const Scan& scan, AtomicFile& file);

}  // namespace curvereg

#endif  // CURVEREG_FILES_KITTI_FILE_H_
