// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Refinement: lays the surface elements of one scan on those of the other, distribution to plane, both ways, with
// Geman-McClure weights and Gauss-Newton steps, from coarse cells to fine ones. The plane between two elements is taken
// with the mean of their normals, which makes the distance exact for surfaces of constant curvature
// [S. Rusinkiewicz, "A symmetric objective function for ICP", ACM TOG 38(4), 2019].
#ifndef CURVEREG_CORE_REFINEMENT_H_
#define CURVEREG_CORE_REFINEMENT_H_

#include <vector>

#include "core/rigid_transform.h"
#include "core/stop.h"
#include "core/voxel_map.h"

namespace curvereg {

struct RefinementOptions {
  int max_iterations = 15;             // per level
  double min_normal_cosine = 0.7;      // elements facing away from each other (45 degrees) are not one surface
  double kernel_sigmas = 2.5;          // Geman-McClure scale in robust standard deviations of the residuals
  double min_kernel_m = 0.01;          // never sharper than this
  double noise_floor_m = 0.005;        // added to an element's own roughness in its weight
  double converged_m = 1e-4;           // a step below both ends the level
  double converged_rad = 1e-5;
};

// How well the surfaces lie on each other at one level.
struct SurfaceFit {
  RigidTransform T_target_source = RigidTransform::Identity();
  Matrix6d information = Matrix6d::Zero();        // J^T W J with unit weights normalised by the residual variance
  Matrix6d cross_information = Matrix6d::Zero();  // the same with one normal from each scan: free of noise bias
  Matrix6d cross_variance = Matrix6d::Zero();     // per direction i,i: variance of cross_information under pure noise
  int num_pairs = 0;                // element pairs found
  int num_elements = 0;             // elements asked
  double inlier_fraction = 0.0;     // pairs within three robust standard deviations floors, of num_pairs
  double residual_rms_m = 0.0;      // robust (kernel-weighted)
  double residual_median_m = 0.0;   // of |residual|
  double residual_p90_m = 0.0;
  int iterations = 0;
  bool converged = false;
};

// Refines on one level from `T_target_source`. Fewer than 6 pairs: num_pairs says so and the pose stays. Ends early at
// a stop request (the pose so far). Deterministic; uses the threads of the innermost WithThreadLimit.
SurfaceFit RefineOnLevel(const VoxelMap& source, const VoxelMap& target, const RigidTransform& T_target_source,
                         const RefinementOptions& options, const Stop& stop);

}  // namespace curvereg

#endif  // CURVEREG_CORE_REFINEMENT_H_
