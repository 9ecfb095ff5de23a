// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/cloud_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "files/atomic_file.h"
#include "files/file_bytes.h"
#include "files/kitti_file.h"
#include "files/las_file.h"
#include "files/pcd_file.h"
#include "files/ply_file.h"
#include "files/text_file.h"

namespace curvereg {
namespace {

constexpr uint64_t kMaxBytesPerPoint = 256;
constexpr uint64_t kMaxHeaderBytes = uint64_t{16} << 20;

// In lower case and without the dot.
std::string EndingOf(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  return absl::AsciiStrToLower(ending.empty() ? ending : ending.substr(1));
}

bool IsTextEnding(std::string_view ending) { return ending == "xyz" || ending == "csv" || ending == "txt"; }

// More than this cannot be a cloud of max_points.
uint64_t MaxBytes(const CloudReadOptions& options) {
  const auto max_points = static_cast<uint64_t>(std::clamp<int64_t>(options.max_points, 0, int64_t{1} << 48));
  return max_points * kMaxBytesPerPoint + kMaxHeaderBytes;
}

absl::StatusOr<CloudWithOrigin> AtFileOrigin(absl::StatusOr<Scan> scan) {
  if (!scan.ok()) return scan.status();
  return CloudWithOrigin{*std::move(scan), Eigen::Vector3d::Zero()};
}

// Content that has no mark of a format: text, or KITTI by its ending.
absl::StatusOr<CloudWithOrigin> ParseUnmarked(std::string_view bytes, const std::string& ending,
                                              const CloudReadOptions& options) {
  const bool is_kitti_ending = ending == "bin";
  if (LooksLikeText(bytes, is_kitti_ending)) {
    absl::StatusOr<Scan> scan = ParseTextCloud(bytes, options);
    const bool is_known = IsTextEnding(ending);
    if (!scan.ok() && !is_known && absl::IsInvalidArgument(scan.status())) {
      return absl::InvalidArgumentError(
          absl::StrCat("is not a PCD, PLY or LAS file, nor text with coordinates: ", scan.status().message()));
    }
    if (scan.ok() && !is_known && scan->points.empty()) {
      return absl::InvalidArgumentError("is not a PCD, PLY or LAS file, but text without coordinates");
    }
    return AtFileOrigin(std::move(scan));
  }
  if (is_kitti_ending) return AtFileOrigin(ParseKitti(bytes, options));
  return absl::InvalidArgumentError(
      "is not a point cloud: no PCD, PLY or LAS header, not text, and the name does not end in .bin (KITTI)");
}

absl::StatusOr<CloudWithOrigin> ParseCloud(std::string_view bytes, const std::string& ending,
                                           const CloudReadOptions& options) {
  if (bytes.empty()) return absl::InvalidArgumentError("is empty");
  if (LooksLikePly(bytes)) return AtFileOrigin(ParsePly(bytes, options));
  if (LooksLikeLas(bytes)) return ParseLas(bytes, options);
  if (LooksLikePcd(bytes)) return AtFileOrigin(ParsePcd(bytes, options));
  return ParseUnmarked(bytes, ending, options);
}

}  // namespace

absl::StatusOr<CloudWithOrigin> ReadCloudFileWithOrigin(const std::string& path, const CloudReadOptions& options) {
  // The first half of the bar is reading, the second is decoding.
  CloudReadOptions halves = options;
  if (options.progress) {
    halves.progress = [&](double share) { options.progress(0.5 + 0.5 * share); };
  }
  std::function<void(double)> read_progress;
  if (options.progress) {
    read_progress = [&](double share) { options.progress(0.5 * share); };
  }
  const absl::StatusOr<FileBytes> bytes = ReadFileBytes(path, MaxBytes(options), read_progress);
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<CloudWithOrigin> cloud = ParseCloud(bytes->view(), EndingOf(path), halves);
  if (!cloud.ok()) return WithPath(path, cloud.status());
  if (options.progress) options.progress(1.0);
  return cloud;
}

absl::StatusOr<Scan> ReadCloudFile(const std::string& path, const CloudReadOptions& options) {
  absl::StatusOr<CloudWithOrigin> cloud = ReadCloudFileWithOrigin(path, options);
  if (!cloud.ok()) return cloud.status();
  return std::move(cloud->scan);
}

absl::Status WriteCloudFile(const std::string& path, const Scan& scan, CloudEncoding encoding) {
  const std::string ending = EndingOf(path);
  if (ending != "pcd" && ending != "ply" && ending != "bin" && !IsTextEnding(ending)) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": cannot write: the name must end in .pcd, .ply, .bin, .xyz, .txt or .csv"));
  }
  absl::StatusOr<AtomicFile> file = AtomicFile::Create(path);
  if (!file.ok()) return file.status();
  if (ending == "pcd") {
    AppendPcd(scan, encoding, *file);
  } else if (ending == "ply") {
    AppendPly(scan, encoding, *file);
  } else if (ending == "bin") {
    AppendKitti(scan, *file);
  } else {
    AppendTextCloud(scan, ending == "csv", *file);
  }
  return file->Commit();
}

bool HasWritableCloudEnding(const std::string& path) { return HasCloudEnding(path) && EndingOf(path) != "las"; }

bool HasCloudEnding(const std::string& path) {
  constexpr std::array<std::string_view, 7> kEndings = {"pcd", "ply", "bin", "xyz", "csv", "txt", "las"};
  return std::find(kEndings.begin(), kEndings.end(), EndingOf(path)) != kEndings.end();
}

}  // namespace curvereg
