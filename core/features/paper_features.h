// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The features of the method `paper` (register_paper.h) of one scan: range image, holes filled, 3x3 Gaussian, values on
// [0, 1]; I_c(j) of the curvelet transform by wrapping; extrema of I_DoC(j) = I_c(j) - I_c(j-1); 128-bin descriptors
// without orientation. The images go around the full circle: no key point or descriptor window meets the seam.
#ifndef CURVEREG_CORE_FEATURES_PAPER_FEATURES_H_
#define CURVEREG_CORE_FEATURES_PAPER_FEATURES_H_

#include <Eigen/Core>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/features/descriptors.h"
#include "core/features/keypoints.h"
#include "core/scan/scan.h"
#include "core/views/range_image.h"

namespace curvereg {

// The defaults are the paper's numbers where it gives them; where it does not, the comment says "ours".
struct PaperFeatureOptions {
  RangeImageOptions image = {.full_sphere = true};  // half a degree: 360 rows, 720 columns
  double blur_sigma_px = 0.5;                       // of the 3x3 Gaussian, in [0, 10]
  int num_scales = 5;                               // J
  // Extrema of I_DoC(3) and I_DoC(4), those with a DoC image on either side; of the image on [0, 1].
  KeypointOptions keypoints = {.first_level = 2,
                               .last_level = 3,
                               .min_response = 0.005,      // low contrast
                               .min_valid_fraction = 0.0,  // no such rejection in the paper
                               .max_per_level = 10'000,    // ours: reached by noise only
                               .border_px = 8};            // ours: half a descriptor window above and below
  // Near-range rejection: no key points nearer than this; >= 0. The value is ours: the ring of ground about a mast of
  // 2 m, where rows of pixels are centimetres apart and follow the sensor.
  double min_range_m = 5.0;
  DescriptorOptions descriptors = {.step_px = 1.0, .oriented = false};
};

// OK, or INVALID_ARGUMENT that names the first option out of its range, but for those of `image` and `num_scales`,
// which ComputePaperFeatures refuses.
absl::Status Validate(const PaperFeatureOptions& options);

struct PaperFeatures {
  Features features;                    // key points in coordinates of the range image
  std::vector<Eigen::Vector3d> points;  // the return under each feature's key point, in the sensor frame [m]
};

// A scan without returns has no features; neither has a key point whose pixel holds no return. INVALID_ARGUMENT: an
// option out of range. CANCELLED, DEADLINE_EXCEEDED: `stop` was requested; asked between steps of a few milliseconds.
absl::StatusOr<PaperFeatures> ComputePaperFeatures(const Scan& scan, const PaperFeatureOptions& options,
                                                   const Stop& stop);

}  // namespace curvereg

#endif  // CURVEREG_CORE_FEATURES_PAPER_FEATURES_H_
