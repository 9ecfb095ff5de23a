// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/report_files.h"

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "core/mapping/point_map.h"
#include "files/cloud_file.h"
#include "files/trajectory_file.h"

namespace curvereg {

absl::Status WriteScanPoses(const std::string& path, const std::vector<std::optional<RigidTransform>>& T_world_scan) {
  std::vector<StampedPose> poses;
  for (std::size_t i = 0; i < T_world_scan.size(); ++i) {
    if (T_world_scan[i]) poses.push_back({.timestamp_s = static_cast<double>(i), .T_world_scan = *T_world_scan[i]});
  }
  return WriteTrajectoryFile(path, poses);
}

absl::Status WriteMergedMap(const std::string& path, const Dataset& dataset,
                            const std::vector<std::optional<RigidTransform>>& T_world_scan,
                            const ReportOptions& options) {
  MapInput input;
  std::vector<std::string> paths;  // of the scans that have a pose
  for (std::size_t i = 0; i < T_world_scan.size(); ++i) {
    if (!T_world_scan[i]) continue;
    input.T_map_scan.push_back(*T_world_scan[i]);
    paths.push_back(dataset.scan_paths[i]);
  }
  input.load = [&](std::size_t index, const Stop&) -> absl::StatusOr<std::shared_ptr<const Scan>> {
    absl::StatusOr<Scan> scan = options.load_scan(paths[index]);
    if (!scan.ok()) return scan.status();
    return std::make_shared<const Scan>(*std::move(scan));
  };
  Scan map;
  const PointMapOptions cells{.cell_m = options.map_cell_m};
  const absl::Status built = BuildPointMap(input, cells, [&map](std::span<const Eigen::Vector3f> points) {
    map.points.insert(map.points.end(), points.begin(), points.end());
    return absl::OkStatus();
  });
  return built.ok() ? WriteCloudFile(path, map) : built;
}

}  // namespace curvereg
