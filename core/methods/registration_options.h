// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a caller may ask of a registration. Stage options belong to their stages.
#ifndef CURVEREG_CORE_METHODS_REGISTRATION_OPTIONS_H_
#define CURVEREG_CORE_METHODS_REGISTRATION_OPTIONS_H_

#include <chrono>
#include <cstdint>
#include <optional>

#include "core/base/rigid_transform.h"
#include "core/base/stop.h"
#include "core/scan/scan.h"

namespace curvereg {

enum class Method {
  kCurvelet,      // "curvelet": bird's-eye curvelet features, refinement, verification, escalation
  kPaper,         // "paper": the published pipeline to the letter
  kFpfhSacIa,     // "fpfh-sac-ia": the paper's first baseline
  kHarris3dFpfh,  // "harris3d-fpfh": the paper's second baseline
  kIcp,           // "icp": refinement alone, from the prior (identity when none is given)
};

// A guess of the transform from odometry or an IMU.
struct Prior {
  RigidTransform T_target_source = RigidTransform::Identity();
  // Of (rotation [rad], translation [m]), left perturbation, target frame. Absent: the guess is only one more
  // hypothesis. Present: poses beyond five standard deviations of it are not considered.
  std::optional<Matrix6d> covariance;
};

struct RegistrationOptions {
  Method method = Method::kCurvelet;
  std::optional<Prior> prior;
  uint64_t seed = 1;                    // of RANSAC; the same seed gives the same bytes
  int num_threads = 0;                  // most threads to use; 0: one per processor
  std::optional<double> time_budget_s;  // at its end: the best pose so far, marked with Reason::kDeadline
  std::stop_token cancellation;         // at its request: absl::CancelledError
  // The same as the end of the time budget, whichever is nearer; of the call, so it is not part of the digest.
  std::optional<std::chrono::steady_clock::time_point> deadline;
  ScanLimits limits;
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_METHODS_REGISTRATION_OPTIONS_H_
