// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Refinement: aligns the surfels of the source to those of the target, distribution to plane, both ways, with
// Geman-McClure weights and Gauss-Newton steps, from coarse cells to fine ones. The distance between two surfels is
// taken along the mean of their normals, which makes it exact for surfaces of constant curvature [Rusinkiewicz 2019].
#ifndef CURVEREG_CORE_POSE_REFINEMENT_H_
#define CURVEREG_CORE_POSE_REFINEMENT_H_

#include <vector>

#include "core/base/rigid_transform.h"
#include "core/base/stop.h"
#include "core/scan/voxel_map.h"

namespace curvereg {

struct RefinementOptions {
  int max_iterations = 15;         // per level
  double min_normal_cosine = 0.7;  // surfels facing away from each other (45 degrees) are not one surface
  double kernel_sigmas = 2.5;      // Geman-McClure scale in robust standard deviations of the residuals
  double min_kernel_m = 0.01;      // never sharper than this
  double noise_floor_m = 0.005;    // added to a surfel's own roughness in its weight
  double converged_m = 1e-4;       // a step below both ends the level
  double converged_rad = 1e-5;
  bool measure_information = true;  // false saves time where only pose and residuals are wanted
};

// Fewer surfel pairs cannot determine the six unknowns of a pose.
inline constexpr int kMinSurfelPairs = 6;

// How well the surfaces fit each other. Directions are tangent vectors as in rigid_transform.h, target frame.
struct SurfaceFit {
  RigidTransform T_target_source = RigidTransform::Identity();
  // Sum of w * J * J^T over the surfel pairs, w the inverse variance of the residuals as observed.
  Matrix6d information = Matrix6d::Zero();
  // The same with one normal from each scan, (J_s * J_t^T + J_t * J_s^T) / 2: noise of the normals is independent
  // between the scans, so it cancels on average, whereas it adds to the information above.
  Matrix6d cross_information = Matrix6d::Zero();
  // What the noise of the normals alone would add to the cross information, as a quartic form: see NoiseVarianceAlong.
  Eigen::Matrix<double, 21, 21> noise_form = Eigen::Matrix<double, 21, 21>::Zero();
  int num_pairs = 0;               // surfel pairs found
  int num_surfels = 0;             // surfels compared
  double inlier_fraction = 0.0;    // pairs nearer than three times their own roughness, of num_pairs, [0, 1]
  double residual_rms_m = 0.0;     // kernel-weighted
  double residual_median_m = 0.0;  // of |residual|
  double residual_p90_m = 0.0;
  int iterations = 0;
  bool converged = false;

  // Variance of direction^T * cross_information * direction if no surface faced the motion along `direction`, so that
  // only the normals' noise contributed.
  double NoiseVarianceAlong(const Vector6d& direction) const;
};

// Levels of a scan's voxel maps, from fine to coarse, both included.
struct LevelRange {
  size_t finest = 0;
  size_t coarsest = 0;
};

// Refines from `T_target_source` on all levels of the range together: fine cells weigh most where both scans are dense,
// coarse ones carry what is thin. Fewer than kMinSurfelPairs: num_pairs says so and the pose stays. Ends early at a
// stop request (the pose so far). Deterministic; uses the threads of the innermost WithThreadLimit. Precondition: both
// vectors hold the levels of the range, with equal cells.
SurfaceFit RefineOnLevels(const std::vector<VoxelMap>& source, const std::vector<VoxelMap>& target, LevelRange levels,
                          const RigidTransform& T_target_source, const RefinementOptions& options, const Stop& stop);

// Covariance of (rotation [rad], translation [m]), target frame, left perturbation: inverse of the information, widened
// because neighbouring surfels do not err independently (factor measured in simulation, see docs/method.md).
Matrix6d PoseCovariance(const SurfaceFit& fit);

}  // namespace curvereg

#endif  // CURVEREG_CORE_POSE_REFINEMENT_H_
