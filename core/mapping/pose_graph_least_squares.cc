// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_least_squares.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/stop_status.h"
#include "core/mapping/pose_graph_covariance.h"
#include "core/mapping/pose_graph_residual.h"
#include "core/mapping/pose_graph_start.h"

namespace curvereg {
namespace {

constexpr double kTrustRadius = 1e8;  // at the start: next to no damping

// A parameter block: rotation matrix and translation, the upper rows of the transform's matrix, column by column.
constexpr int kPoseSize = 12;
using PoseMatrix = Eigen::Matrix<double, 3, 4>;
using RowMajorJacobian = Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>;

RigidTransform ToTransform(const double* pose) {
  RigidTransform T = RigidTransform::Identity();
  T.matrix().topRows<3>() = Eigen::Map<const PoseMatrix>(pose);
  return T;
}

void FromTransform(const RigidTransform& T, double* pose) {
  Eigen::Map<PoseMatrix> matrix(pose);
  matrix = T.matrix().topRows<3>();
}

// Left perturbations in the frame of the component's first node. In these coordinates a part of the graph moves as one
// body on a straight line, however far it turns, which lets long loops close in few steps. Ceres asks for the edges'
// derivatives by the entries of the block and multiplies them by PlusJacobian; EdgeCost gives those by the perturbation
// at once, in the first columns, and PlusJacobian picks these out.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    FromTransform(TransformFromVector(Eigen::Map<const Vector6d>(delta)) * ToTransform(x), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    const RigidTransform change = ToTransform(y) * ToTransform(x).inverse();
    Eigen::Map<Vector6d> difference(y_minus_x);
    difference << VectorFromRotation(change.linear()), change.translation();
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<RowMajorJacobian>(jacobian).setIdentity();
    return true;
  }
};

// The whitened error times the root of a weight that changes from problem to problem. Zero at a stop, so that Ceres
// ends where it is: it asks its callbacks only between steps, which take long in large graphs, and complains of costs
// that fail.
class EdgeCost final : public ceres::SizedCostFunction<6, kPoseSize, kPoseSize> {
 public:
  EdgeCost(const PoseGraphEdge& edge, const Matrix6d& whitening, const double& weight, const Stop& stop)
      : edge_(edge), whitening_(whitening), weight_(weight), stop_(stop) {}

  bool Evaluate(double const* const* poses, double* residuals, double** jacobians) const override {
    if (stop_.Requested()) return Nothing(residuals, jacobians);
    const RigidTransform T_first_source = ToTransform(poses[0]), T_first_target = ToTransform(poses[1]);
    const Matrix6d scale = std::sqrt(weight_) * whitening_;
    Eigen::Map<Vector6d> error(residuals);
    error = scale * EdgeError(edge_.T_target_source, T_first_source, T_first_target);
    if (jacobians == nullptr) return true;
    const EdgeDerivatives derivatives = DifferentiateEdge(edge_.T_target_source, T_first_source, T_first_target);
    Write(scale * derivatives.by_source * PerturbationToMove(T_first_source), jacobians[0]);
    Write(scale * derivatives.by_target * PerturbationToMove(T_first_target), jacobians[1]);
    return true;
  }

 private:
  static bool Nothing(double* residuals, double** jacobians) {
    Eigen::Map<Vector6d>(residuals).setZero();
    for (int i = 0; jacobians != nullptr && i < 2; ++i) Write(Matrix6d::Zero(), jacobians[i]);
    return true;
  }

  static void Write(const Matrix6d& derivatives, double* jacobian) {
    if (jacobian == nullptr) return;
    Eigen::Map<RowMajorJacobian> block(jacobian);
    block.setZero();
    block.leftCols<6>() = derivatives;
  }

  const PoseGraphEdge& edge_;
  const Matrix6d whitening_;
  const double& weight_;
  const Stop& stop_;
};

// Ends after the first step that made the sum smaller, or at a stop.
class OneStep final : public ceres::IterationCallback {
 public:
  explicit OneStep(const Stop& stop) : stop_(stop) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (stop_.Requested()) return ceres::SOLVER_ABORT;
    return summary.iteration > 0 && summary.step_is_successful ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
                                                               : ceres::SOLVER_CONTINUE;
  }

 private:
  const Stop& stop_;
};

std::vector<Matrix6d> WhiteningOfEdges(const PoseGraph& graph, const PoseGraphOptions& options) {
  constexpr int kEdgesPerTask = 64;
  std::vector<Matrix6d> whitening(graph.edges.size());
  const auto num_edges = static_cast<int>(whitening.size());
  ParallelFor((num_edges + kEdgesPerTask - 1) / kEdgesPerTask, [&](int task) {
    const int end = std::min(num_edges, (task + 1) * kEdgesPerTask);
    for (auto i = static_cast<size_t>(task * kEdgesPerTask); i < static_cast<size_t>(end); ++i)
      whitening[i] = Whitening(graph.edges[i].covariance, options);
  });
  return whitening;
}

ceres::Problem::Options Borrowing() {
  ceres::Problem::Options options;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;  // indices were checked
  return options;
}

}  // namespace

struct PoseGraphLeastSquares::State {
  const PoseGraph& graph;
  const Stop stop;
  std::vector<int> first_node;
  std::vector<RigidTransform> T_graph_node;
  std::vector<double> blocks;  // kPoseSize for each node: T_first_node
  std::vector<double> weights;
  std::vector<Matrix6d> whitening;
  std::deque<EdgeCost> costs;  // which cannot be moved
  PoseManifold manifold;
  ceres::Problem problem{Borrowing()};
  double trust_radius = kTrustRadius;

  double* Block(int node) { return blocks.data() + kPoseSize * static_cast<size_t>(node); }
  const RigidTransform& FirstPose(size_t node) const { return T_graph_node[static_cast<size_t>(first_node[node])]; }
  bool Held(int node) const { return first_node[static_cast<size_t>(node)] == node; }
};

PoseGraphLeastSquares::PoseGraphLeastSquares(const PoseGraph& graph, const PoseGraphOptions& options, Stop stop)
    : state_(new State{.graph = graph,
                       .stop = std::move(stop),
                       .first_node = FirstNodes(graph),
                       .T_graph_node = {},
                       .blocks = {},
                       .weights = {},
                       .whitening = {},
                       .costs = {},
                       .manifold = {}}) {
  State& state = *state_;
  state.blocks.resize(kPoseSize * graph.T_graph_node.size());
  SetPoses(graph.T_graph_node);
  state.weights.assign(graph.edges.size(), 1.0);
  state.whitening = WhiteningOfEdges(graph, options);
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const PoseGraphEdge& edge = graph.edges[i];
    state.costs.emplace_back(edge, state.whitening[i], state.weights[i], state.stop);
    for (const int node : {edge.source, edge.target})
      if (!state.problem.HasParameterBlock(state.Block(node)))
        state.problem.AddParameterBlock(state.Block(node), kPoseSize, &state.manifold);
    state.problem.AddResidualBlock(&state.costs.back(), nullptr, state.Block(edge.source), state.Block(edge.target));
  }
  for (size_t i = 0; i < state.first_node.size(); ++i) {
    const auto node = static_cast<int>(i);
    if (state.Held(node) && state.problem.HasParameterBlock(state.Block(node)))
      state.problem.SetParameterBlockConstant(state.Block(node));
  }
}

PoseGraphLeastSquares::~PoseGraphLeastSquares() = default;

const std::vector<RigidTransform>& PoseGraphLeastSquares::poses() const { return state_->T_graph_node; }

void PoseGraphLeastSquares::SetPoses(const std::vector<RigidTransform>& T_graph_node) {
  state_->T_graph_node = T_graph_node;
  state_->trust_radius = kTrustRadius;
  for (size_t i = 0; i < T_graph_node.size(); ++i)
    FromTransform(state_->FirstPose(i).inverse() * T_graph_node[i], state_->Block(static_cast<int>(i)));
}

double PoseGraphLeastSquares::SquaredError(int edge, const RigidTransform& T_graph_source,
                                           const RigidTransform& T_graph_target) const {
  const auto i = static_cast<size_t>(edge);
  return (state_->whitening[i] * EdgeError(state_->graph.edges[i].T_target_source, T_graph_source, T_graph_target))
      .squaredNorm();
}

std::vector<double> PoseGraphLeastSquares::SquaredErrors() const {
  std::vector<double> squares;
  for (size_t i = 0; i < state_->whitening.size(); ++i) {
    const PoseGraphEdge& edge = state_->graph.edges[i];
    squares.push_back(SquaredError(static_cast<int>(i), poses()[static_cast<size_t>(edge.source)],
                                   poses()[static_cast<size_t>(edge.target)]));
  }
  return squares;
}

absl::Status PoseGraphLeastSquares::Improve(const std::vector<double>& weights) {
  State& state = *state_;
  if (absl::Status status = StopStatus(state.stop, "the optimisation"); !status.ok()) return status;
  std::copy(weights.begin(), weights.end(), state.weights.begin());
  OneStep callback(state.stop);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // Eigen's: the others call a BLAS that may add up in another order on another number of threads.
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.num_threads = 1;          // Ceres adds up gradients thread by thread
  options.max_num_iterations = 20;  // of which all but the last failed
  options.initial_trust_region_radius = state.trust_radius;
  options.max_trust_region_radius = 1e12;
  options.function_tolerance = options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &state.problem, &summary);
  if (absl::Status status = StopStatus(state.stop, "the optimisation"); !status.ok()) return status;
  if (!summary.IsSolutionUsable())
    return absl::InvalidArgumentError("the pose graph holds numbers that cannot be computed with");
  if (!summary.iterations.empty()) state.trust_radius = std::max(1e2, summary.iterations.back().trust_region_radius);
  for (size_t i = 0; i < state.T_graph_node.size(); ++i)
    if (!state.Held(static_cast<int>(i)))
      state.T_graph_node[i] = Orthonormalised(state.FirstPose(i) * ToTransform(state.Block(static_cast<int>(i))));
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Matrix6d>> PoseGraphLeastSquares::Covariances(const std::vector<double>& weights) const {
  const State& state = *state_;
  std::vector<int> place(state.first_node.size(), -1);
  int size = 0;
  for (size_t i = 0; i < place.size(); ++i)
    if (!state.Held(static_cast<int>(i))) place[i] = size++;
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row_node, int column_node, const Matrix6d& block) {
    const int row = place[static_cast<size_t>(row_node)], column = place[static_cast<size_t>(column_node)];
    if (row < column || column < 0) return;
    for (int c = 0; c < 6; ++c)
      for (int r = 0; r < 6; ++r) entries.emplace_back(6 * row + r, 6 * column + c, block(r, c));
  };
  for (size_t i = 0; i < weights.size(); ++i) {
    const PoseGraphEdge& edge = state.graph.edges[i];
    const EdgeDerivatives derivatives = DifferentiateEdge(
        edge.T_target_source, poses()[static_cast<size_t>(edge.source)], poses()[static_cast<size_t>(edge.target)]);
    const Matrix6d by_source = std::sqrt(weights[i]) * state.whitening[i] * derivatives.by_source;
    const Matrix6d by_target = std::sqrt(weights[i]) * state.whitening[i] * derivatives.by_target;
    add(edge.source, edge.source, by_source.transpose() * by_source);
    add(edge.target, edge.target, by_target.transpose() * by_target);
    add(edge.source, edge.target, by_source.transpose() * by_target);
    add(edge.target, edge.source, by_target.transpose() * by_source);
  }
  Eigen::SparseMatrix<double> information(6 * size, 6 * size);
  information.setFromTriplets(entries.begin(), entries.end());
  const auto blocks = DiagonalBlocksOfInverse(information, state.stop);
  if (!blocks.ok()) return blocks.status();
  std::vector<Matrix6d> covariances(place.size(), Matrix6d::Zero());
  for (size_t i = 0; i < place.size(); ++i)
    if (place[i] >= 0) covariances[i] = CovarianceAboutGraph(poses()[i], (*blocks)[static_cast<size_t>(place[i])]);
  return covariances;
}

}  // namespace curvereg
