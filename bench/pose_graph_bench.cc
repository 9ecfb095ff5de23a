// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The pose graph of 1,000 scans on five laps, 4 links back from each and 100 loop closures, a tenth of all wrong,
// beside one sparse Cholesky factorisation (Eigen, analysis included) of a matrix of the same pattern. One thread.
#include "core/mapping/pose_graph.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "bench/median_time.h"
#include "sim/random.h"

namespace curvereg {
namespace {

constexpr int kNodes = 1000, kLap = 200, kLinks = 4, kClosures = 100;
constexpr double kSigmaRad = 5e-4, kSigmaM = 5e-3;

RigidTransform TruePose(int node) {
  const double angle = 2.0 * std::numbers::pi * node / kLap;
  Vector6d pose;
  pose << 0.05 * std::sin(node), 0.05 * std::cos(node), angle, 48.0 * std::cos(angle), 48.0 * std::sin(angle),
      0.01 * node;
  return TransformFromVector(pose);
}

class GraphMaker {
 public:
  PoseGraph Make() {
    for (int node = 0; node < kNodes; ++node) {
      for (int back = 1; back <= std::min(kLinks, node); ++back) AddEdge(node, node - back);
      graph_.T_graph_node.push_back(node == 0 ? TruePose(0)
                                              : graph_.T_graph_node.back() * graph_.edges[first_edge_].T_target_source);
      first_edge_ = graph_.edges.size();
    }
    for (int i = 0; i < kClosures; ++i) {
      const int node = kLap + static_cast<int>(random_.Uniform(0.0, kNodes - kLap));
      AddEdge(node, node - kLap + static_cast<int>(random_.Uniform(0.0, 3.0)));
    }
    return graph_;
  }

 private:
  void AddEdge(int source, int target) {
    Vector6d sigmas;
    sigmas << Eigen::Vector3d::Constant(kSigmaRad), Eigen::Vector3d::Constant(kSigmaM);
    Vector6d error;
    for (double& number : error) number = random_.Normal();
    error = error.cwiseProduct(sigmas);
    if (random_.Uniform() < 0.1) error += Normals(random_.Uniform() < 0.5 ? 0.3 : 10.0);
    PoseGraphEdge edge{.source = source, .target = target};
    edge.T_target_source = TransformFromVector(error) * TruePose(target).inverse() * TruePose(source);
    edge.covariance = sigmas.cwiseAbs2().asDiagonal();
    graph_.edges.push_back(edge);
  }

  Vector6d Normals(double size_m) {
    Vector6d numbers;
    for (double& number : numbers) number = size_m * random_.Normal();
    numbers.head<3>() /= 10.0;
    return numbers;
  }

  sim::RandomStream random_{11};
  PoseGraph graph_;
  size_t first_edge_ = 0;  // of the node at work
};

// Positive definite, with a block for each node and edge.
Eigen::SparseMatrix<double> SamePattern(const PoseGraph& graph) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int column, double scale) {
    for (int i = 0; i < 36; ++i)
      entries.emplace_back(6 * row + i / 6, 6 * column + i % 6, scale * (i % 7 == 0 ? 1.0 : 0.05));
  };
  for (const PoseGraphEdge& edge : graph.edges) {
    add(edge.source, edge.source, 1.1);
    add(edge.target, edge.target, 1.1);
    add(std::max(edge.source, edge.target), std::min(edge.source, edge.target), -1.0);
  }
  Eigen::SparseMatrix<double> matrix(6 * kNodes, 6 * kNodes);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

int Run() {
  const PoseGraph graph = GraphMaker().Make();
  const Eigen::SparseMatrix<double> matrix = SamePattern(graph);
  PoseGraphOptions options{.with_covariances = false, .num_threads = 1};
  const auto result = OptimizePoseGraph(graph, options);
  if (!result.ok() || !result->converged) {
    std::fprintf(stderr, "not optimised: %s\n", std::string(result.status().message()).c_str());
    return 1;
  }
  PoseGraphOptions with_covariances{.num_threads = 1};
  const std::vector<double> seconds =
      bench::MedianSeconds(7, {[&] { Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix); },
                               [&] { static_cast<void>(OptimizePoseGraph(graph, options)); },
                               [&] { static_cast<void>(OptimizePoseGraph(graph, with_covariances)); }});
  std::printf("%d scans, %zu edges, %d iterations; medians of 7 rounds of processor time\n", kNodes, graph.edges.size(),
              result->iterations);
  std::printf("%-36s %9.1f ms\n", "one sparse Cholesky", 1e3 * seconds[0]);
  std::printf("%-36s %9.1f ms, ratio %.1f\n", "OptimizePoseGraph, no covariances", 1e3 * seconds[1],
              seconds[1] / seconds[0]);
  std::printf("%-36s %9.1f ms, ratio %.1f\n", "OptimizePoseGraph", 1e3 * seconds[2], seconds[2] / seconds[0]);
  return 0;
}

}  // namespace
}  // namespace curvereg

int main() { return curvereg::Run(); }
