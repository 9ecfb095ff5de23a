// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The method `paper`: the published pipeline to the letter, nothing added [S. Ahuja, P. Iles, S. L. Waslander, "3D Scan
// Registration using Curvelet Features in Planetary Environments"]. Range image, holes filled, 3x3 Gaussian, [0, 1];
// I_c(j) of the curvelet transform by wrapping; extrema of I_DoC(j) = I_c(j) - I_c(j-1); 128-bin descriptors without
// orientation; approximate mutual nearest neighbours; RANSAC; SVD.
//
// How far to trust it: works for motions of decimetres only, since a panorama changes too much with the viewpoint. The
// verdict is no better than counting inliers: what is fixed to the sensor (scan pattern, near ring, image border)
// matches itself from scan to scan, and then "no motion" has a large, confident consensus.
#ifndef CURVEREG_CORE_METHODS_REGISTER_PAPER_H_
#define CURVEREG_CORE_METHODS_REGISTER_PAPER_H_

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/features/approximate_matching.h"
#include "core/features/paper_features.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"
#include "core/pose/ransac.h"
#include "core/scan/scan.h"

namespace curvereg {

// The defaults are ours: the paper gives no numbers for these steps.
struct PaperOptions {
  PaperFeatureOptions features;
  ApproximateMatchingOptions matching;
  RansacOptions ransac;
  // Accepted when chance would be expected to bring forth a consensus as large less often than this, see
  // LogFalseAlarms. In (0, 1). The paper has no verdict; what it counts is inliers.
  double max_false_alarms = 1e-3;
};

// OK, or INVALID_ARGUMENT that names the first option out of its range.
absl::Status Validate(const PaperOptions& options);

// T_target_source with counts and stage times; the caller fills digests, seed and total time. Reasons for rejection:
// kTooFewFeatures (fewer than three matches), kNoConsensus (no pose, or one that chance explains), kDeadline. A
// rejected answer has a pose when RANSAC found one. INVALID_ARGUMENT: an option out of range. CANCELLED: the stop's
// cancellation. Uses the threads of the innermost WithThreadLimit.
absl::StatusOr<RegistrationResult> RegisterPaper(const Scan& source, const Scan& target, const PaperOptions& options,
                                                 const Stop& stop);

// The same with the defaults and the seed of `options`; prior and gravity are not used, the paper has none.
absl::StatusOr<RegistrationResult> RegisterPaper(const Scan& source, const Scan& target,
                                                 const RegistrationOptions& options, const Stop& stop);

}  // namespace curvereg

#endif  // CURVEREG_CORE_METHODS_REGISTER_PAPER_H_
