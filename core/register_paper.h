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
#ifndef CURVEREG_CORE_REGISTER_PAPER_H_
#define CURVEREG_CORE_REGISTER_PAPER_H_

#include <Eigen/Core>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/approximate_matching.h"
#include "core/descriptors.h"
#include "core/keypoints.h"
#include "core/range_image.h"
#include "core/ransac.h"
#include "core/registration_options.h"
#include "core/registration_result.h"
#include "core/scan.h"
#include "core/stop.h"

namespace curvereg {

// The defaults are the paper's numbers where it gives them; where it does not, the comment says "ours".
struct PaperOptions {
  RangeImageOptions image = {.full_sphere = true};  // half a degree, 720 columns; 360 rows from zenith to nadir
  double blur_sigma_px = 0.5;                       // of the 3x3 Gaussian
  int num_scales = 5;                               // J
  // Extrema of I_DoC(3) and I_DoC(4), those with a DoC image on either side; of the image on [0, 1].
  KeypointOptions keypoints = {.first_level = 2,
                               .last_level = 3,
                               .min_response = 0.005,   // low contrast
                               .min_valid_share = 0.0,  // no such rejection in the paper
                               .max_per_level = 1'000'000,
                               .border_px = 8};  // ours: half a descriptor window above and below
  double min_range_m = 5.0;                      // near-range rejection: key points nearer than this; the value is ours
  DescriptorOptions descriptors = {.step_px = 1.0, .oriented = false};
  ApproximateMatchingOptions matching;  // ours
  RansacOptions ransac;                 // ours
  // Ours: accepted when chance would be expected to bring forth a consensus as large less often than this, see
  // LogFalseAlarms. In (0, 1).
  double max_false_alarms = 1e-3;
};

// OK, or INVALID_ARGUMENT that names the first option out of its range, but for those of `image` and `num_scales`,
// which ComputePaperFeatures refuses.
absl::Status Validate(const PaperOptions& options);

// Features of one scan and where they are.
struct PaperFeatures {
  Features features;
  std::vector<Eigen::Vector3d> points;  // of each feature, in the sensor frame [m]
};

// A scan without returns has no features. INVALID_ARGUMENT: an option out of range. CANCELLED, DEADLINE_EXCEEDED:
// `stop` was requested; it is asked between steps of a few milliseconds.
absl::StatusOr<PaperFeatures> ComputePaperFeatures(const Scan& scan, const PaperOptions& options, const Stop& stop);

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

#endif  // CURVEREG_CORE_REGISTER_PAPER_H_
