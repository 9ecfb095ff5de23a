// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the benchmarks measure on: uneven ground strewn with humps, scanned from two places some metres apart.
#ifndef CURVEREG_BENCH_BENCH_SCENE_H_
#define CURVEREG_BENCH_BENCH_SCENE_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/features/view_features.h"
#include "core/methods/prepared_scan.h"

namespace curvereg::bench {

// Upright sensor 1.6 m above the ground at (x, y), turned by `yaw_rad`: T_world_sensor.
RigidTransform BenchPose(double x, double y, double yaw_rad);

// 224 000 returns, all on the ground: 1000 x 224 beams, 360 degrees around, 40 to 2 degrees down, noise of about 5 mm.
std::vector<Eigen::Vector3f> BenchScan(const RigidTransform& T_world_sensor);

// A pair as a registration meets it, and its elevation views (upright).
struct BenchPair {
  RigidTransform T_world_source = BenchPose(4.0, 2.0, 0.5);
  RigidTransform T_world_target = BenchPose(0.0, 0.0, 0.0);
  std::vector<Eigen::Vector3f> source = BenchScan(T_world_source);
  std::vector<Eigen::Vector3f> target = BenchScan(T_world_target);
  RigidTransform T_target_source = T_world_target.inverse() * T_world_source;
};
ViewFeatures BenchView(const std::vector<Eigen::Vector3f>& points);
std::unique_ptr<const PreparedScan> BenchPrepared(const std::vector<Eigen::Vector3f>& points);

}  // namespace curvereg::bench

#endif  // CURVEREG_BENCH_BENCH_SCENE_H_
