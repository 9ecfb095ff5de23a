// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Geman and McClure's kernel: what an edge costs by its squared error r^2, in standard deviations, at the scale c. Near
// the truth it is r^2, far from it no more than c^2.
#ifndef CURVEREG_CORE_MAPPING_POSE_GRAPH_KERNEL_H_
#define CURVEREG_CORE_MAPPING_POSE_GRAPH_KERNEL_H_

namespace curvereg {

// c^2 r^2 / (r^2 + c^2).
inline double KernelCost(double squared_error, double squared_scale) {
  return squared_scale * squared_error / (squared_error + squared_scale);
}

// The cost's derivative by r^2, (c^2 / (r^2 + c^2))^2: the edge's weight in least squares that take the cost's place.
inline double KernelWeight(double squared_error, double squared_scale) {
  const double root = squared_scale / (squared_error + squared_scale);
  return root * root;
}

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_POSE_GRAPH_KERNEL_H_
