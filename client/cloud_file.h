// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Point cloud files. The format is taken from the content where it has a magic number, else from the name's ending.
#ifndef CURVEREG_CLIENT_CLOUD_FILE_H_
#define CURVEREG_CLIENT_CLOUD_FILE_H_

#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/scan.h"

namespace curvereg {

struct CloudReadOptions {
  int64_t max_points = 50'000'000;       // a file that declares or holds more is refused
  std::function<void(double)> progress;  // called with the share done in [0, 1], from the calling thread; may be empty
};

// Reads PCD (ascii, binary, binary_compressed), PLY (ascii, binary little and big endian), KITTI .bin,
// XYZ/CSV/TXT text and LAS 1.2-1.4 (point formats 0-10, not LAZ). Coordinates in metres as the file has them; points
// that are not finite are kept as "no return". LAS: the header's offset is subtracted when coordinates would not fit
// float32 to a millimetre, and the message log of the caller is not touched.
// Errors name the file and the cause: NOT_FOUND, PERMISSION_DENIED, INVALID_ARGUMENT (not a cloud, wrong ending),
// DATA_LOSS (truncated, corrupt, header lies about its size), RESOURCE_EXHAUSTED (more than max_points).
absl::StatusOr<Scan> ReadCloudFile(const std::string& path, const CloudReadOptions& options = {});

enum class CloudEncoding { kBinary, kAscii };

// Writes PCD or PLY (by ending; little-endian float32 x y z), or KITTI .bin / .xyz. Written to a temporary beside it
// and renamed when complete: a full disk leaves no half-written file. Errors name the file and the cause.
absl::Status WriteCloudFile(const std::string& path, const Scan& scan, CloudEncoding encoding = CloudEncoding::kBinary);

// True when the name's ending is one that ReadCloudFile reads.
bool HasCloudEnding(const std::string& path);

}  // namespace curvereg

#endif  // CURVEREG_CLIENT_CLOUD_FILE_H_
