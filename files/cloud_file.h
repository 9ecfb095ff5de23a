// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Point cloud files. The format is taken from the content where it has a magic number, else from the name's ending.
#ifndef CURVEREG_FILES_CLOUD_FILE_H_
#define CURVEREG_FILES_CLOUD_FILE_H_

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/scan/scan.h"

namespace curvereg {

struct CloudReadOptions {
  int64_t max_points = 50'000'000;       // a file that declares or holds more is refused
  std::function<void(double)> progress;  // called with the share done in [0, 1], from the calling thread; may be empty
};

// Reads PCD (ascii, binary, binary_compressed), PLY (ascii, binary little and big endian), KITTI .bin,
// XYZ/CSV/TXT text and LAS 1.2-1.4 (point formats 0-10, not LAZ). A file whose content is one of these is read as such
// whatever its ending; only KITTI, which has no mark, needs its own. Coordinates in metres as the file has them; points
// that are not finite are kept as "no return". LAS: coordinates too large for float32 to hold to a millimetre are given
// relative to an origin, see ReadCloudFileWithOrigin.
// Errors name the file and the cause: NOT_FOUND, PERMISSION_DENIED, INVALID_ARGUMENT (a folder, empty, not a cloud,
// wrong ending), DATA_LOSS (truncated, corrupt, header lies about its size), RESOURCE_EXHAUSTED (more than max_points,
// or a file larger than max_points points of 256 bytes). No memory is reserved on a header's word alone.
absl::StatusOr<Scan> ReadCloudFile(const std::string& path, const CloudReadOptions& options = {});

struct CloudWithOrigin {
  Scan scan;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // in the file's frame [m]; what was subtracted from every point
};

// The same, and returns what was subtracted. Zero but for LAS files with coordinates of 16384 m or more: there it is
// the header's offset or, should that not bring the points near enough, their middle in whole metres.
absl::StatusOr<CloudWithOrigin> ReadCloudFileWithOrigin(const std::string& path, const CloudReadOptions& options = {});

enum class CloudEncoding { kBinary, kAscii };

// Writes by the name's ending: .pcd or .ply (float32 x y z), KITTI .bin (reflectance 0, always binary), .xyz, .txt or
// .csv (always text). Text has the shortest digits that read back as the same float32; `gravity` is not written.
// Written to a temporary beside it and renamed when complete: a full disk leaves no half-written file. Errors name the
// file and the cause: INVALID_ARGUMENT (another ending, a folder), NOT_FOUND (no such folder), PERMISSION_DENIED,
// RESOURCE_EXHAUSTED (disk full).
absl::Status WriteCloudFile(const std::string& path, const Scan& scan, CloudEncoding encoding = CloudEncoding::kBinary);

// True when the name's ending, in any case, is one that ReadCloudFile reads: pcd, ply, bin, xyz, csv, txt, las.
bool HasCloudEnding(const std::string& path);

// True when the name's ending is one that WriteCloudFile writes.
bool HasWritableCloudEnding(const std::string& path);

}  // namespace curvereg

#endif  // CURVEREG_FILES_CLOUD_FILE_H_
