// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The rigid fit of a scan's points to themselves moved, and of three points, beside a copy of the points.
#include "core/pose/rigid_fit.h"

#include <span>

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const curvereg::RigidTransform pose = curvereg::bench::BenchPose(4.0, 2.0, 0.5);
  const std::vector<Eigen::Vector3f> points = curvereg::bench::BenchScan(pose);
  std::vector<curvereg::PointPair> pairs;
  for (const Eigen::Vector3f& point : points) pairs.push_back({point.cast<double>(), pose * point.cast<double>()});
  const std::span<const curvereg::PointPair> three(&pairs[points.size() / 2], 3);
  return curvereg::bench::PrintRatios(argc, argv, curvereg::bench::CopyOf(points),
                                      {{"FitRigidTransform, " + std::to_string(pairs.size()) + " pairs",
                                        [&] { static_cast<void>(curvereg::FitRigidTransform(pairs)); }},
                                       {"FitRigidTransform, 3 pairs, 1000 times", [&] {
                                          for (int i = 0; i < 1000; ++i)
                                            static_cast<void>(curvereg::FitRigidTransform(three));
                                        }}});
}
