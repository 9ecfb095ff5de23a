// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/las_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "absl/strings/str_cat.h"
#include "files/file_bytes.h"
#include "files/read_progress.h"

namespace curvereg {
namespace {

// From here on neighbouring float32 numbers are 2^-9 m apart.
constexpr double kMaxExactCoordinate = 16384.0;

constexpr std::size_t kMinHeaderBytes = 227;          // LAS 1.2
constexpr std::size_t kMinHeaderBytesVersion4 = 375;  // LAS 1.4

// Of metres per step, and metres: far more than any map needs, so that no sum of them overflows.
constexpr double kMaxScale = 1e3;
constexpr double kMaxOffset = 1e9;

// Least record length of each point record format, LAS 1.4 R15 tables 7-17.
constexpr std::array<std::size_t, 11> kMinRecordBytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

struct LasHeader {
  std::size_t data_offset = 0;
  std::size_t record_bytes = 0;
  std::size_t num_points = 0;
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

absl::Status CheckFormat(std::string_view bytes) {
  const int major = static_cast<unsigned char>(bytes[24]);
  const int minor = static_cast<unsigned char>(bytes[25]);
  if (major != 1 || minor > 4) {
    return absl::InvalidArgumentError(absl::StrCat("LAS version ", major, ".", minor, " is not 1.0 to 1.4"));
  }
  const auto format = static_cast<unsigned char>(bytes[104]);
  if ((format & 0xC0) != 0) {
    return absl::InvalidArgumentError("compressed (LAZ), which is not supported; convert it to LAS first");
  }
  if (format >= kMinRecordBytes.size()) {
    return absl::InvalidArgumentError(absl::StrCat("LAS point record format ", int{format}, " is not 0 to 10"));
  }
  const auto record_bytes = LoadLittleEndian<uint16_t>(bytes.data() + 105);
  if (record_bytes < kMinRecordBytes[format]) {
    return absl::DataLossError(
        absl::StrCat("LAS point records of ", record_bytes, " bytes are shorter than format ", int{format}, " needs"));
  }
  return absl::OkStatus();
}

absl::StatusOr<LasHeader> ParseHeader(std::string_view bytes) {
  if (bytes.size() < kMinHeaderBytes) return absl::DataLossError("truncated in the LAS header");
  if (const absl::Status status = CheckFormat(bytes); !status.ok()) return status;
  LasHeader header;
  const std::size_t header_bytes = LoadLittleEndian<uint16_t>(bytes.data() + 94);
  header.data_offset = LoadLittleEndian<uint32_t>(bytes.data() + 96);
  header.record_bytes = LoadLittleEndian<uint16_t>(bytes.data() + 105);
  header.num_points = LoadLittleEndian<uint32_t>(bytes.data() + 107);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    header.scale[axis] = LoadLittleEndian<double>(bytes.data() + 131 + 8 * axis);
    header.offset[axis] = LoadLittleEndian<double>(bytes.data() + 155 + 8 * axis);
  }
  if (bytes[25] == 4) {
    // Version 1.4 counts in 64 bits; the old field is zero where 32 do not suffice or the format is a new one.
    if (bytes.size() < kMinHeaderBytesVersion4) return absl::DataLossError("truncated in the LAS header");
    const auto num_points = LoadLittleEndian<uint64_t>(bytes.data() + 247);
    if (num_points > 0) header.num_points = num_points;
  }
  if (header_bytes < kMinHeaderBytes || header.data_offset < header_bytes) {
    return absl::DataLossError("LAS header is inconsistent: the points begin inside the header");
  }
  // Written so that NaN fails, too.
  if (!(header.scale.array() > 0.0).all() || !(header.scale.array() <= kMaxScale).all() ||
      !(header.offset.array().abs() <= kMaxOffset).all()) {
    return absl::DataLossError("LAS header: scale or offset is not a valid number");
  }
  return header;
}

Eigen::Vector3d LoadRaw(std::string_view records, const LasHeader& header, std::size_t i) {
  const char* record = records.data() + i * header.record_bytes;
  return {static_cast<double>(LoadLittleEndian<int32_t>(record)),
          static_cast<double>(LoadLittleEndian<int32_t>(record + 4)),
          static_cast<double>(LoadLittleEndian<int32_t>(record + 8))};
}

// What to subtract so that float32 holds the points to a millimetre.
Eigen::Vector3d ChooseOrigin(std::string_view records, const LasHeader& header) {
  if (header.num_points == 0) return Eigen::Vector3d::Zero();
  Eigen::Vector3d low = LoadRaw(records, header, 0);
  Eigen::Vector3d high = low;
  for (std::size_t i = 1; i < header.num_points; ++i) {
    const Eigen::Vector3d raw = LoadRaw(records, header, i);
    low = low.cwiseMin(raw);
    high = high.cwiseMax(raw);
  }
  low = low.cwiseProduct(header.scale);
  high = high.cwiseProduct(header.scale);
  const auto is_exact = [&](const Eigen::Vector3d& origin) {
    const Eigen::Vector3d shift = header.offset - origin;
    return (low + shift).cwiseAbs().cwiseMax((high + shift).cwiseAbs()).maxCoeff() < kMaxExactCoordinate;
  };
  if (is_exact(Eigen::Vector3d::Zero())) return Eigen::Vector3d::Zero();
  if (is_exact(header.offset)) return header.offset;
  return (0.5 * (low + high) + header.offset).array().round();
}

}  // namespace

bool LooksLikeLas(std::string_view bytes) { return bytes.starts_with("LASF"); }

absl::StatusOr<CloudWithOrigin> ParseLas(std::string_view bytes, const CloudReadOptions& options) {
  const absl::StatusOr<LasHeader> header = ParseHeader(bytes);
  if (!header.ok()) return header.status();
  const std::string_view records = bytes.substr(std::min(header->data_offset, bytes.size()));
  if (header->num_points > records.size() / header->record_bytes) {
    return absl::DataLossError(absl::StrCat("truncated, or wrong header: LAS header declares ", header->num_points,
                                            " points of ", header->record_bytes, " bytes, the file holds ",
                                            records.size(), " bytes of them"));
  }
  if (header->num_points > static_cast<uint64_t>(std::max<int64_t>(options.max_points, 0))) {
    return absl::ResourceExhaustedError(
        absl::StrCat("contains ", header->num_points, " points, more than the limit of ", options.max_points));
  }
  CloudWithOrigin cloud;
  cloud.origin = ChooseOrigin(records, *header);
  const Eigen::Vector3d shift = header->offset - cloud.origin;
  cloud.scan.points.resize(header->num_points);
  ReadProgress progress(options, header->num_points);
  for (std::size_t i = 0; i < header->num_points; ++i) {
    cloud.scan.points[i] = (LoadRaw(records, *header, i).cwiseProduct(header->scale) + shift).cast<float>();
    progress.At(i);
  }
  return cloud;
}

}  // namespace curvereg
