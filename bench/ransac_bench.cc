// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// RANSAC over 300 pairs of points of which every tenth is right, and FLANN's matching of as many features, beside a
// copy of a scan's points.
#include "core/pose/ransac.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"
#include "core/features/approximate_matching.h"

namespace {

std::vector<curvereg::PointPair> Pairs(const curvereg::bench::BenchPair& scans) {
  std::vector<curvereg::PointPair> pairs;
  for (size_t i = 0; i < 300; ++i) {
    const Eigen::Vector3d source = scans.source[(i * 7919) % scans.source.size()].cast<double>();
    const Eigen::Vector3d other = scans.target[(i * 104729) % scans.target.size()].cast<double>();
    pairs.push_back({source, i % 10 == 0 ? Eigen::Vector3d(scans.T_target_source * source) : other});
  }
  return pairs;
}

}  // namespace

int main(int argc, char** argv) {
  const curvereg::bench::BenchPair scans;
  const std::vector<curvereg::PointPair> pairs = Pairs(scans);
  const curvereg::Features source = curvereg::bench::BenchView(scans.source).features;
  const curvereg::Features target = curvereg::bench::BenchView(scans.target).features;
  const std::string sizes = std::to_string(source.size()) + " x " + std::to_string(target.size());
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(scans.source),
      {{"FindRigidConsensus, 300 pairs, 10 % right",
        [&] { static_cast<void>(curvereg::FindRigidConsensus(pairs, {}, curvereg::Stop{})); }},
       {"MatchApproximateMutualNearest, " + sizes,
        [&] { static_cast<void>(curvereg::MatchApproximateMutualNearest(source, target, {}, curvereg::Stop{})); }}});
}
