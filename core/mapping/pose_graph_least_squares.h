// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Weighted least squares over the poses of a graph (Levenberg-Marquardt, sparse Cholesky; Ceres). One object serves a
// series of problems that differ in the edges' weights only.
#ifndef CURVEREG_CORE_MAPPING_POSE_GRAPH_LEAST_SQUARES_H_
#define CURVEREG_CORE_MAPPING_POSE_GRAPH_LEAST_SQUARES_H_

#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/mapping/pose_graph.h"

namespace curvereg {

class PoseGraphLeastSquares {
 public:
  // The first node of each component is held. Starts at the poses of `graph`, which must outlive the object and be
  // valid.
  PoseGraphLeastSquares(const PoseGraph& graph, const PoseGraphOptions& options, Stop stop = {});
  ~PoseGraphLeastSquares();

  const std::vector<RigidTransform>& poses() const;  // T_graph_node
  void SetPoses(const std::vector<RigidTransform>& T_graph_node);

  // Squared lengths of the edges' errors at the poses, in standard deviations.
  std::vector<double> SquaredErrors() const;

  double SquaredError(int edge, const RigidTransform& T_graph_source, const RigidTransform& T_graph_target) const;

  // One step towards the least sum of weights times squared errors; none when it would not get smaller.
  // CANCELLED, DEADLINE_EXCEEDED; INVALID_ARGUMENT: the numbers are beyond what can be computed with.
  absl::Status Improve(const std::vector<double>& weights);

  // Covariances as PoseGraphResult has them.
  absl::StatusOr<std::vector<Matrix6d>> Covariances(const std::vector<double>& weights) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_POSE_GRAPH_LEAST_SQUARES_H_
