// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// LAS 1.0-1.4, the airborne-laser exchange format, point record formats 0-10; not LAZ, its compressed form.
#ifndef CURVEREG_FILES_LAS_FILE_H_
#define CURVEREG_FILES_LAS_FILE_H_

#include <Eigen/Core>
#include <string_view>

#include "absl/status/statusor.h"
#include "files/cloud_file.h"

namespace curvereg {

// True when `bytes` begins with "LASF".
bool LooksLikeLas(std::string_view bytes);

// The points of a LAS file that is in memory. Errors as ReadCloudFile, without the file's name; LAZ is
// INVALID_ARGUMENT. LAS holds integers with a scale and an offset, often in a map's frame, where float32 has steps of
// decimetres. When some coordinate is 16384 m or more (float32 steps of 2 mm, so errors of up to 1 mm), all are given
// relative to CloudWithOrigin::origin: the header's offset, or the middle of the points, rounded to metres, should the
// offset not bring them near enough.
absl::StatusOr<CloudWithOrigin> ParseLas(std::string_view bytes, const CloudReadOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_FILES_LAS_FILE_H_
