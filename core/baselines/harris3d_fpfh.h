// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The paper's second baseline: normals, Harris 3-D key points, their FPFH descriptors, nearest descriptors matched,
// matches rejected by RANSAC, ICP.
#ifndef CURVEREG_CORE_BASELINES_HARRIS3D_FPFH_H_
#define CURVEREG_CORE_BASELINES_HARRIS3D_FPFH_H_

#include "absl/status/statusor.h"
#include "core/baselines/baseline.h"
#include "core/scan/scan.h"

namespace curvereg {

// All stages are PCL's; its RANSAC is given the seed of the options. Scans without three described key points each: OK,
// failure kTooFewFeatures; matches that agree on no pose: OK, failure kNoConsensus.
// INVALID_ARGUMENT: a scan or an option that cannot be used; CANCELLED.
absl::StatusOr<BaselineResult> RegisterHarris3dFpfh(const Scan& source, const Scan& target,
                                                    const BaselineOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASELINES_HARRIS3D_FPFH_H_
