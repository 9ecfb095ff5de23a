// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/leveling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/small_matrices.h"

namespace curvereg {
namespace {

struct PlanarSurfel {
  Eigen::Vector3d normal;
  Eigen::Vector3d mean;
  double weight;  // [m^2]
};

std::vector<PlanarSurfel> PlanarSurfels(const std::vector<VoxelMap>& maps, double planarity) {
  std::vector<PlanarSurfel> surfels;
  for (size_t level = 1; level < maps.size(); ++level) {
    const double cell = maps[level].cell_m();
    const double limit = std::pow(planarity * cell, 2);
    for (const Surfel& surfel : maps[level].surfels()) {
      // A line of points (one scan ring) has no normal, however flat it is.
      const bool planar = surfel.normal_variance < limit && surfel.middle_variance > 4.0F * surfel.normal_variance &&
                          surfel.middle_variance > 0.01 * cell * cell;
      if (planar) surfels.push_back({surfel.normal.cast<double>(), surfel.mean.cast<double>(), cell * cell});
    }
  }
  return surfels;
}

struct Cluster {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double weight = 0.0;
};

// Weight and principal axis of the surfels within the cone about `axis`.
Cluster RefitCluster(const std::vector<PlanarSurfel>& surfels, const std::vector<bool>& taken,
                     const Eigen::Vector3d& axis, double min_cosine) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Cluster cluster;
  for (size_t i = 0; i < surfels.size(); ++i) {
    if (taken[i] || std::abs(surfels[i].normal.dot(axis)) < min_cosine) continue;
    scatter.noalias() += surfels[i].weight * surfels[i].normal * surfels[i].normal.transpose();
    cluster.weight += surfels[i].weight;
  }
  if (cluster.weight > 0.0) {
    cluster.axis = EigenOf(scatter).vectors.col(2);
  }
  return cluster;
}

// Directions to start from: a coarse histogram of normals over the half sphere; its heaviest bins.
std::vector<Eigen::Vector3d> SeedAxes(const std::vector<PlanarSurfel>& surfels, const std::vector<bool>& taken) {
  constexpr int kBins = 24;  // per cube axis: about 4 degrees
  constexpr size_t kSeeds = 12;
  struct Bin {
    double weight = 0.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  };
  std::vector<Bin> bins(static_cast<size_t>(3 * kBins * kBins));
  for (size_t i = 0; i < surfels.size(); ++i) {
    if (taken[i]) continue;
    int axis = 0;
    surfels[i].normal.cwiseAbs().maxCoeff(&axis);
    const Eigen::Vector3d n = surfels[i].normal[axis] < 0.0 ? -surfels[i].normal : surfels[i].normal;
    const auto bin_of = [&](double value) {
      return std::clamp(static_cast<int>((value / n[axis] + 1.0) * 0.5 * kBins), 0, kBins - 1);
    };
    const int u = bin_of(n[(axis + 1) % 3]);
    const int v = bin_of(n[(axis + 2) % 3]);
    Bin& bin = bins[static_cast<size_t>((axis * kBins + u) * kBins + v)];
    bin.weight += surfels[i].weight;
    bin.sum += surfels[i].weight * n;
  }
  std::stable_sort(bins.begin(), bins.end(), [](const Bin& a, const Bin& b) { return a.weight > b.weight; });
  std::vector<Eigen::Vector3d> seeds;
  for (size_t i = 0; i < std::min(kSeeds, bins.size()) && bins[i].weight > 0.0; ++i) {
    seeds.push_back(bins[i].sum.normalized());
  }
  return seeds;
}

Cluster StrongestCluster(const std::vector<PlanarSurfel>& surfels, const std::vector<bool>& taken, double min_cosine) {
  Cluster best;
  for (const Eigen::Vector3d& seed : SeedAxes(surfels, taken)) {
    Cluster cluster;
    cluster.axis = seed;
    for (int iteration = 0; iteration < 5; ++iteration) {
      cluster = RefitCluster(surfels, taken, cluster.axis, min_cosine);
    }
    if (cluster.weight > best.weight) best = cluster;
  }
  return best;
}

// The floor is nearer to the sensor than what it faces: the side with more nearby surface parallel to it is down.
Eigen::Vector3d PointedUp(const std::vector<PlanarSurfel>& surfels, const Eigen::Vector3d& axis, double min_cosine) {
  double above = 0.0;
  double below = 0.0;
  for (const PlanarSurfel& surfel : surfels) {
    if (std::abs(surfel.normal.dot(axis)) < min_cosine) continue;
    const double height = surfel.mean.dot(axis);
    (height > 0.0 ? above : below) += surfel.weight / std::pow(1.0 + height * height, 2);
  }
  return above > below ? Eigen::Vector3d(-axis) : axis;
}

LevelingCandidate CandidateFromUp(const Eigen::Vector3d& up, double weight) {
  LevelingCandidate candidate;
  candidate.R_level_sensor = RotationBetween(up, Eigen::Vector3d::UnitZ());
  candidate.weight = weight;
  return candidate;
}

}  // namespace

std::vector<LevelingCandidate> FindVerticals(const std::vector<VoxelMap>& maps,
                                             const std::optional<Eigen::Vector3d>& gravity,
                                             const LevelingOptions& options) {
  if (gravity.has_value()) return {CandidateFromUp(-gravity->normalized(), 0.0)};
  const std::vector<PlanarSurfel> surfels = PlanarSurfels(maps, options.planarity);
  const double min_cosine = std::cos(options.cluster_rad);
  std::vector<bool> taken(surfels.size(), false);
  std::vector<LevelingCandidate> candidates;
  while (static_cast<int>(candidates.size()) < options.max_candidates) {
    const Cluster cluster = StrongestCluster(surfels, taken, min_cosine);
    if (cluster.weight <= 0.0) break;
    if (!candidates.empty() && cluster.weight < options.min_relative_weight * candidates.front().weight) break;
    candidates.push_back(CandidateFromUp(PointedUp(surfels, cluster.axis, min_cosine), cluster.weight));
    for (size_t i = 0; i < surfels.size(); ++i) {
      if (std::abs(surfels[i].normal.dot(cluster.axis)) >= min_cosine) taken[i] = true;
    }
  }
  if (candidates.empty()) candidates.push_back(LevelingCandidate{});
  return candidates;
}

}  // namespace curvereg
