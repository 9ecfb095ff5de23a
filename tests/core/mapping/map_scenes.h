// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tests of maps share: scans by index, and maps as vectors.
#ifndef CURVEREG_TESTS_CORE_MAPPING_MAP_SCENES_H_
#define CURVEREG_TESTS_CORE_MAPPING_MAP_SCENES_H_

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "core/mapping/map_cells.h"
#include "core/mapping/point_map.h"
#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"

namespace curvereg::testing {

// Scans with their poses, and how often each was asked for.
struct MapScene {
  std::vector<std::shared_ptr<const Scan>> scans;
  std::vector<RigidTransform> T_map_scan;
  mutable std::vector<int> num_loads;

  void Add(Scan scan, const RigidTransform& T) {
    scans.push_back(std::make_shared<const Scan>(std::move(scan)));
    T_map_scan.push_back(T);
    num_loads.push_back(0);
  }
  MapInput Input() const {
    return {T_map_scan, [this](std::size_t index, const Stop&) -> absl::StatusOr<std::shared_ptr<const Scan>> {
              ++num_loads[index];
              return scans[index];
            }};
  }
};

inline std::vector<Eigen::Vector3f> PointsOf(const MapScene& scene, const PointMapOptions& options) {
  std::vector<Eigen::Vector3f> points;
  const auto collect = [&](std::span<const Eigen::Vector3f> piece) {
    points.insert(points.end(), piece.begin(), piece.end());
    return absl::OkStatus();
  };
  EXPECT_THAT(BuildPointMap(scene.Input(), options, collect), IsOk());
  return points;
}

inline std::vector<MapCell> CellsOf(const MapScene& scene, const PointMapOptions& options) {
  std::vector<MapCell> cells;
  const auto collect = [&](std::span<const MapCell> piece) {
    cells.insert(cells.end(), piece.begin(), piece.end());
    return absl::OkStatus();
  };
  EXPECT_THAT(VisitMapCells(scene.Input(), options, collect), IsOk());
  return cells;
}

// Points strewn over gently rolling ground along a strip in x, `num_scans` scans of 20 m, 2 m apart.
inline MapScene Strip(int num_scans, int points_per_scan) {
  MapScene scene;
  Random random(5);
  for (int i = 0; i < num_scans; ++i) {
    const RigidTransform T_map_scan = UprightPose(2.0 * i, 0.5 * i, 0.1 * i);
    Scan scan;
    for (int j = 0; j < points_per_scan; ++j) {
      const Eigen::Vector3d at =
          T_map_scan.translation() + Eigen::Vector3d(random.Uniform(-10.0, 10.0), random.Uniform(-10.0, 10.0), 0.0);
      const Eigen::Vector3d ground(at.x(), at.y(), 0.4 * std::sin(0.3 * at.x()) + 0.2 * std::cos(0.5 * at.y()));
      scan.points.push_back((T_map_scan.inverse() * ground).cast<float>());
    }
    scene.Add(std::move(scan), T_map_scan);
  }
  return scene;
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_CORE_MAPPING_MAP_SCENES_H_
