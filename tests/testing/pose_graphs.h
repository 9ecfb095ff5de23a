// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Pose graphs of drives whose truth is known.
#ifndef CURVEREG_TESTS_TESTING_POSE_GRAPHS_H_
#define CURVEREG_TESTS_TESTING_POSE_GRAPHS_H_

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/mapping/pose_graph.h"
#include "sim/random.h"

namespace curvereg::testing {

inline Matrix6d DiagonalCovariance(double sigma_rad, double sigma_m) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_rad * sigma_rad), Eigen::Vector3d::Constant(sigma_m * sigma_m);
  return variances.asDiagonal();
}

inline Vector6d NormalVector(sim::RandomStream& random) {
  Vector6d vector;
  for (double& number : vector) number = random.Normal();
  return vector;
}

// Positive definite, correlated, deviations about those given.
inline Matrix6d RandomCovariance(sim::RandomStream& random, double sigma_rad, double sigma_m) {
  Matrix6d mix;
  for (double& number : mix.reshaped()) number = random.Normal();
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(sigma_rad), Eigen::Vector3d::Constant(sigma_m);
  return sigmas.asDiagonal() * (Matrix6d::Identity() + 0.2 * mix * mix.transpose()) * sigmas.asDiagonal();
}

struct KnownGraph {
  PoseGraph graph;
  std::vector<RigidTransform> T_graph_node;  // the truth

  // Adds an edge whose transform is off by `error` (left perturbation).
  void AddEdge(int source, int target, const Matrix6d& covariance, const Vector6d& error = Vector6d::Zero()) {
    PoseGraphEdge edge{.source = source, .target = target, .covariance = covariance};
    edge.T_target_source = TransformFromVector(error) * T_graph_node[static_cast<size_t>(target)].inverse() *
                           T_graph_node[static_cast<size_t>(source)];
    graph.edges.push_back(edge);
  }
};

constexpr double kDriveSigmaRad = 5e-4;
constexpr double kDriveSigmaM = 5e-3;

// A ring of `num_nodes` places 1.5 m apart on wavy ground; edges from each to the three before it, with noise of the
// deviations above. First guesses: chained through the edges from node to node.
inline KnownGraph Drive(int num_nodes, uint64_t seed) {
  sim::RandomStream random(seed);
  KnownGraph drive;
  for (int i = 0; i < num_nodes; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / num_nodes, radius = 1.5 * num_nodes / (2.0 * std::numbers::pi);
    Vector6d pose;
    pose << 0.05 * std::sin(i), 0.05 * std::cos(1.3 * i), angle, radius * std::cos(angle), radius * std::sin(angle),
        0.3 * std::sin(0.7 * i);
    drive.T_graph_node.push_back(TransformFromVector(pose));
  }
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(kDriveSigmaRad), Eigen::Vector3d::Constant(kDriveSigmaM);
  for (int i = 1; i < num_nodes; ++i)
    for (int back = 1; back <= std::min(3, i); ++back)
      drive.AddEdge(i, i - back, DiagonalCovariance(kDriveSigmaRad, kDriveSigmaM),
                    sigmas.cwiseProduct(NormalVector(random)));
  drive.graph.T_graph_node.assign(1, drive.T_graph_node[0]);
  for (const PoseGraphEdge& edge : drive.graph.edges)
    if (edge.target == edge.source - 1)
      drive.graph.T_graph_node.push_back(drive.graph.T_graph_node.back() * edge.T_target_source);
  return drive;
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_POSE_GRAPHS_H_
