// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/trajectory_file.h"

#include <cmath>
#include <cstdint>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "files/atomic_file.h"
#include "files/file_bytes.h"
#include "files/text_fields.h"

namespace curvereg {
namespace {

constexpr std::size_t kTumColumns = 8;
constexpr std::size_t kKittiColumns = 12;
constexpr uint64_t kMaxBytes = uint64_t{1} << 30;

// How far a rotation may be from orthonormal, and a quaternion's length from 1, and still be one with few decimals.
constexpr double kRotationTolerance = 0.01;

absl::Status LineError(int64_t line, absl::string_view cause) {
  return absl::InvalidArgumentError(absl::StrCat("line ", line, ": ", cause));
}

absl::StatusOr<std::vector<double>> ParseNumbers(std::string_view line) {
  std::vector<double> numbers;
  for (std::string_view field = NextField(line); !field.empty(); field = NextField(line)) {
    const std::optional<double> number = ParseDouble(field);
    if (!number.has_value() || !std::isfinite(*number)) {
      return absl::InvalidArgumentError(absl::StrCat(Quoted(field), " is not a finite number"));
    }
    numbers.push_back(*number);
    if (numbers.size() > kKittiColumns) break;
  }
  return numbers;
}

absl::StatusOr<StampedPose> PoseFromTum(const std::vector<double>& numbers) {
  Eigen::Quaterniond q(numbers[7], numbers[4], numbers[5], numbers[6]);
  if (!(std::abs(q.norm() - 1.0) <= kRotationTolerance)) {
    return absl::InvalidArgumentError(absl::StrCat("the quaternion has length ", q.norm(), ", not 1"));
  }
  StampedPose pose;
  pose.timestamp_s = numbers[0];
  pose.T_world_scan.linear() = q.normalized().toRotationMatrix();
  pose.T_world_scan.translation() = Eigen::Vector3d(numbers[1], numbers[2], numbers[3]);
  return pose;
}

absl::StatusOr<StampedPose> PoseFromKitti(const std::vector<double>& numbers, std::size_t index) {
  StampedPose pose;
  pose.timestamp_s = static_cast<double>(index);
  pose.T_world_scan.affine() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(numbers.data());
  if (!IsRigid(pose.T_world_scan, kRotationTolerance)) {
    return absl::InvalidArgumentError("columns 1-3, 5-7, 9-11 are not a rotation matrix");
  }
  pose.T_world_scan = Orthonormalised(pose.T_world_scan);
  return pose;
}

std::string TumLine(const StampedPose& pose) {
  Eigen::Quaterniond q(pose.T_world_scan.linear());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const Eigen::Vector3d t = pose.T_world_scan.translation();
  return absl::StrFormat("%.9f %.12f %.12f %.12f %.15f %.15f %.15f %.15f\n", pose.timestamp_s, t.x(), t.y(), t.z(),
                         q.x(), q.y(), q.z(), q.w());
}

std::string KittiLine(const StampedPose& pose) {
  std::string line;
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index col = 0; col < 4; ++col) {
      absl::StrAppendFormat(&line, "%.15e%c", pose.T_world_scan(row, col), row == 2 && col == 3 ? '\n' : ' ');
    }
  }
  return line;
}

}  // namespace

absl::StatusOr<std::vector<StampedPose>> ParseTrajectory(std::string_view text) {
  std::vector<StampedPose> poses;
  std::size_t num_columns = 0;
  LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.Next()) {
    std::string_view rest = *line;
    const std::string_view first = NextField(rest);
    if (first.empty() || first[0] == '#') continue;
    const absl::StatusOr<std::vector<double>> numbers = ParseNumbers(*line);
    if (!numbers.ok()) return LineError(lines.line_number(), numbers.status().message());
    if (numbers->size() != kTumColumns && numbers->size() != kKittiColumns) {
      return LineError(lines.line_number(),
                       absl::StrCat("has ", numbers->size(), numbers->size() > 12 ? " or more" : "",
                                    " numbers, TUM has 8 and KITTI 12"));
    }
    if (num_columns != 0 && numbers->size() != num_columns) {
      return LineError(lines.line_number(),
                       absl::StrCat("has ", numbers->size(), " numbers, the lines before have ", num_columns));
    }
    num_columns = numbers->size();
    const absl::StatusOr<StampedPose> pose =
        num_columns == kTumColumns ? PoseFromTum(*numbers) : PoseFromKitti(*numbers, poses.size());
    if (!pose.ok()) return LineError(lines.line_number(), pose.status().message());
    poses.push_back(*pose);
  }
  if (poses.empty()) return absl::InvalidArgumentError("contains no poses");
  return poses;
}

absl::StatusOr<std::vector<StampedPose>> ReadTrajectoryFile(const std::string& path) {
  const absl::StatusOr<FileBytes> bytes = ReadFileBytes(path, kMaxBytes);
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<std::vector<StampedPose>> poses = ParseTrajectory(bytes->view());
  if (!poses.ok()) return WithPath(path, poses.status());
  return poses;
}

absl::StatusOr<std::string> TrajectoryText(const std::vector<StampedPose>& poses, TrajectoryFormat format,
                                           const std::string& world) {
  std::string text;
  if (format == TrajectoryFormat::kTum) {
    text = absl::StrCat("# T_world_scan: scan (sensor) frame to ", world,
                        " frame, metres, seconds\n"
                        "# timestamp tx ty tz qx qy qz qw\n");
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!std::isfinite(poses[i].timestamp_s) || !IsRigid(poses[i].T_world_scan)) {
      return absl::InvalidArgumentError(absl::StrCat("pose ", i, " is not a finite rigid transform"));
    }
    text += format == TrajectoryFormat::kTum ? TumLine(poses[i]) : KittiLine(poses[i]);
  }
  return text;
}

absl::Status WriteTrajectoryFile(const std::string& path, const std::vector<StampedPose>& poses,
                                 TrajectoryFormat format) {
  const absl::StatusOr<std::string> text = TrajectoryText(poses, format);
  if (!text.ok()) return WithPath(path, text.status());
  return WriteFileAtomically(path, *text);
}

}  // namespace curvereg
