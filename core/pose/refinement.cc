// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pose/refinement.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/base/small_matrices.h"

namespace curvereg {
namespace {

constexpr double kInlierSigmas = 6.0;  // of the means' spread, about three of the surfels' own roughness
constexpr size_t kBlock = 2048;        // surfels per task; fixed, so that sums have one order

// One surfel of each scan, taken for the same piece of surface, under the current pose.
struct SurfelPair {
  Eigen::Vector3d point_target;   // source surfel's mean, moved to the target frame
  Eigen::Vector3d normal;         // mean of both normals, target frame
  Eigen::Vector3d source_normal;  // moved to the target frame
  Eigen::Vector3d target_normal;
  double residual;       // signed distance along the normal [m]
  double inverse_sigma;  // of the residual, from both surfels' roughness [1/m]
  double normal_noise;   // product of the standard deviations of both normals' directions [rad^2]
};

// Of a surfel's mean along its normal [m^2]: sampling noise falls with the number of points, but the two scans sample
// a rough surface at different places, and that part stays.
double VarianceOfMean(const Surfel& surfel) {
  constexpr double kLasting = 0.2;
  return static_cast<double>(surfel.normal_variance) * (1.0 / surfel.count + kLasting);
}

// Variance [rad^2] of the direction of a surfel's normal.
double VarianceOfNormal(const Surfel& surfel) {
  return static_cast<double>(surfel.normal_variance) / (static_cast<double>(surfel.middle_variance) * surfel.count);
}

// The surfel of `map` at `point`; failing that, of the cell across the nearest face.
int FindNear(const VoxelMap& map, const Eigen::Vector3f& point) {
  const int own = map.Find(point);
  if (own >= 0) return own;
  const auto cell = static_cast<float>(map.cell_m());
  int best = -1;
  float best_distance = cell * cell;
  for (int axis = 0; axis < 3; ++axis) {
    const float position = point[axis] / cell;
    const float side = position - std::floor(position) < 0.5F ? -0.5F : 0.5F;
    Eigen::Vector3f neighbour = point;
    neighbour[axis] += side * cell;
    const int found = map.Find(neighbour);
    if (found < 0) continue;
    const float distance = (map.surfels()[static_cast<size_t>(found)].mean - point).squaredNorm();
    if (distance < best_distance) {
      best_distance = distance;
      best = found;
    }
  }
  return best;
}

class PairFinder {
 public:
  PairFinder(const VoxelMap& source, const VoxelMap& target, const RefinementOptions& options)
      : source_(source), target_(target), options_(options) {}

  size_t num_surfels() const { return source_.surfels().size() + target_.surfels().size(); }

  // Appends pairs of each source surfel with the target's grid, then of each target surfel with the source's grid:
  // two grids average out where their cells happen to cut the surface.
  void Find(const RigidTransform& T_target_source, std::vector<SurfelPair>& pairs) const {
    const size_t num_source = source_.surfels().size();
    const size_t num_all = num_source + target_.surfels().size();
    const RigidTransform T_source_target = T_target_source.inverse();
    std::vector<std::vector<SurfelPair>> blocks((num_all + kBlock - 1) / kBlock);
    ParallelFor(static_cast<int>(blocks.size()), [&](int block) {
      std::vector<SurfelPair>& found = blocks[static_cast<size_t>(block)];
      found.reserve(kBlock);
      const size_t begin = static_cast<size_t>(block) * kBlock;
      for (size_t i = begin; i < std::min(num_all, begin + kBlock); ++i) {
        const Surfel* s = nullptr;
        const Surfel* t = nullptr;
        if (i < num_source) {
          s = &source_.surfels()[i];
          const int index = FindNear(target_, (T_target_source * s->mean.cast<double>()).cast<float>());
          if (index >= 0) t = &target_.surfels()[static_cast<size_t>(index)];
        } else {
          t = &target_.surfels()[i - num_source];
          const int index = FindNear(source_, (T_source_target * t->mean.cast<double>()).cast<float>());
          if (index >= 0) s = &source_.surfels()[static_cast<size_t>(index)];
        }
        if (s != nullptr && t != nullptr) AddPair(*s, *t, T_target_source, found);
      }
    });
    for (const std::vector<SurfelPair>& block : blocks) pairs.insert(pairs.end(), block.begin(), block.end());
  }

 private:
  void AddPair(const Surfel& s, const Surfel& t, const RigidTransform& T, std::vector<SurfelPair>& pairs) const {
    if (!s.has_normal || !t.has_normal) return;
    SurfelPair pair;
    pair.source_normal = T.linear() * s.normal.cast<double>();
    pair.target_normal = t.normal.cast<double>();
    const double cosine = pair.source_normal.dot(pair.target_normal);
    if (std::abs(cosine) < options_.min_normal_cosine) return;
    if (cosine < 0.0) pair.source_normal = -pair.source_normal;
    pair.normal = (pair.source_normal + pair.target_normal).normalized();
    pair.point_target = T * s.mean.cast<double>();
    pair.residual = pair.normal.dot(t.mean.cast<double>() - pair.point_target);
    const double floor = options_.noise_floor_m;
    pair.inverse_sigma = 1.0 / std::sqrt(VarianceOfMean(s) + VarianceOfMean(t) + floor * floor);
    pair.normal_noise = std::sqrt(VarianceOfNormal(s) * VarianceOfNormal(t));
    pairs.push_back(pair);
  }

  const VoxelMap& source_;
  const VoxelMap& target_;
  const RefinementOptions& options_;
};

Vector6d Jacobian(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  Vector6d J;
  J << point.cross(normal), normal;
  return J;
}

double MedianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Scale of the Geman-McClure kernel on residuals in units of their sigma.
double KernelScale(const std::vector<SurfelPair>& pairs, const RefinementOptions& options) {
  std::vector<double> magnitudes(pairs.size());
  double mean_inverse_sigma = 0.0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    magnitudes[i] = std::abs(pairs[i].residual) * pairs[i].inverse_sigma;
    mean_inverse_sigma += pairs[i].inverse_sigma;
  }
  mean_inverse_sigma /= static_cast<double>(pairs.size());
  return std::max(options.kernel_sigmas * 1.4826 * MedianOf(magnitudes), options.min_kernel_m * mean_inverse_sigma);
}

double KernelWeight(double normalised_residual, double scale) {
  const double ratio = scale * scale / (scale * scale + normalised_residual * normalised_residual);
  return ratio * ratio;
}

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();

  void Add(const NormalEquations& other) {
    H += other.H;
    g += other.g;
  }
};

NormalEquations Accumulate(const std::vector<SurfelPair>& pairs, double kernel_scale) {
  std::vector<NormalEquations> blocks((pairs.size() + kBlock - 1) / kBlock);
  ParallelFor(static_cast<int>(blocks.size()), [&](int block) {
    NormalEquations& sum = blocks[static_cast<size_t>(block)];
    const size_t begin = static_cast<size_t>(block) * kBlock;
    for (size_t i = begin; i < std::min(pairs.size(), begin + kBlock); ++i) {
      const SurfelPair& pair = pairs[i];
      const double weight =
          KernelWeight(pair.residual * pair.inverse_sigma, kernel_scale) * pair.inverse_sigma * pair.inverse_sigma;
      const Vector6d J = Jacobian(pair.point_target, pair.normal);
      sum.H.noalias() += (weight * J) * J.transpose();
      sum.g.noalias() += (weight * pair.residual) * J;
    }
  });
  NormalEquations total;
  for (const NormalEquations& block : blocks) total.Add(block);
  return total;
}

using Vector21d = Eigen::Matrix<double, 21, 1>;

// Upper triangle, off-diagonal entries doubled, so that v^T A v is a dot product with the products of v's entries.
Vector21d PackSymmetric(const Matrix6d& A) {
  Vector21d packed;
  int k = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) packed[k++] = i == j ? A(i, j) : 2.0 * A(i, j);
  }
  return packed;
}

void MeasureResiduals(const std::vector<SurfelPair>& pairs, double kernel_scale, SurfaceFit& fit) {
  std::vector<double> magnitudes(pairs.size());
  double weight_sum = 0.0, squared_m = 0.0;
  int inliers = 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const double e = pairs[i].residual * pairs[i].inverse_sigma;
    const double weight = KernelWeight(e, kernel_scale);
    weight_sum += weight;
    squared_m += weight * pairs[i].residual * pairs[i].residual;
    if (std::abs(e) < kInlierSigmas) ++inliers;
    magnitudes[i] = std::abs(pairs[i].residual);
  }
  fit.inlier_fraction = static_cast<double>(inliers) / static_cast<double>(pairs.size());
  fit.residual_rms_m = std::sqrt(squared_m / weight_sum);
  fit.residual_median_m = MedianOf(magnitudes);
  const auto p90 = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() * 9 / 10);
  std::nth_element(magnitudes.begin(), p90, magnitudes.end());
  fit.residual_p90_m = *p90;
}

void MeasureInformation(const std::vector<SurfelPair>& pairs, double kernel_scale, SurfaceFit& fit) {
  constexpr size_t kNoiseStride = 4;  // a sample is enough for a variance
  double weight_sum = 0.0, squared = 0.0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const SurfelPair& pair = pairs[i];
    const double e = pair.residual * pair.inverse_sigma;
    const double kernel_weight = KernelWeight(e, kernel_scale);
    weight_sum += kernel_weight;
    squared += kernel_weight * e * e;
    const double w = kernel_weight * pair.inverse_sigma * pair.inverse_sigma;
    const Vector6d J = Jacobian(pair.point_target, pair.normal);
    const Vector6d J_s = Jacobian(pair.point_target, pair.source_normal);
    const Vector6d J_t = Jacobian(pair.point_target, pair.target_normal);
    fit.information.noalias() += (w * J) * J.transpose();
    fit.cross_information.noalias() += (0.5 * w) * (J_s * J_t.transpose() + J_t * J_s.transpose());
    if (i % kNoiseStride != 0) continue;
    // The motion of the point along a direction v is D * v; its noise-only share has the size |D * v|^2.
    Eigen::Matrix<double, 3, 6> D;
    D << 0.0, pair.point_target.z(), -pair.point_target.y(), 1.0, 0.0, 0.0,  //
        -pair.point_target.z(), 0.0, pair.point_target.x(), 0.0, 1.0, 0.0,   //
        pair.point_target.y(), -pair.point_target.x(), 0.0, 0.0, 0.0, 1.0;
    const Vector21d packed = PackSymmetric((w * pair.normal_noise) * (D.transpose() * D));
    fit.noise_form.selfadjointView<Eigen::Lower>().rankUpdate(packed, static_cast<double>(kNoiseStride));
  }
  const double variance = std::max(squared / weight_sum, 1e-12);
  fit.information /= variance;
  fit.cross_information /= variance;
  fit.noise_form /= variance * variance;
}

}  // namespace

double SurfaceFit::NoiseVarianceAlong(const Vector6d& direction) const {
  Vector21d products;
  int k = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) products[k++] = direction[i] * direction[j];
  }
  return products.dot(noise_form.selfadjointView<Eigen::Lower>() * products);
}

SurfaceFit RefineOnLevels(const std::vector<VoxelMap>& source, const std::vector<VoxelMap>& target, LevelRange levels,
                          const RigidTransform& T_target_source, const RefinementOptions& options, const Stop& stop) {
  SurfaceFit fit;
  fit.T_target_source = T_target_source;
  std::vector<PairFinder> finders;
  for (size_t level = levels.finest; level <= levels.coarsest; ++level) {
    finders.emplace_back(source[level], target[level], options);
    fit.num_surfels += static_cast<int>(finders.back().num_surfels());
  }
  std::vector<SurfelPair> pairs;
  const auto find_pairs = [&] {
    pairs.clear();
    for (const PairFinder& finder : finders) finder.Find(fit.T_target_source, pairs);
    fit.num_pairs = static_cast<int>(pairs.size());
    return fit.num_pairs >= kMinSurfelPairs;
  };
  double kernel_scale = 1.0;
  for (fit.iterations = 0; fit.iterations < options.max_iterations && !fit.converged; ++fit.iterations) {
    if (!find_pairs()) return fit;
    if (stop.Requested()) break;
    kernel_scale = KernelScale(pairs, options);
    NormalEquations equations = Accumulate(pairs, kernel_scale);
    // A whiff of damping keeps an unobserved direction where it is.
    equations.H.diagonal() *= 1.0 + 1e-9;
    equations.H.diagonal().array() += 1e-9 * equations.H.trace();
    const Vector6d delta = SolveSymmetric(equations.H, equations.g);
    if (!delta.allFinite()) break;
    fit.T_target_source = TransformFromVector(delta) * fit.T_target_source;
    fit.converged = delta.tail<3>().norm() < options.converged_m && delta.head<3>().norm() < options.converged_rad;
  }
  fit.T_target_source = Orthonormalised(fit.T_target_source);
  if (!find_pairs()) return fit;
  MeasureResiduals(pairs, kernel_scale, fit);
  if (options.measure_information) MeasureInformation(pairs, kernel_scale, fit);
  return fit;
}

Matrix6d PoseCovariance(const SurfaceFit& fit) {
  constexpr double kWidening = 8.0;
  Matrix6d information = fit.information;
  information.diagonal().array() += 1e-9 * information.trace() + 1e-12;
  return kWidening * InverseOfSymmetric(information);
}

}  // namespace curvereg
