// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The paper's first baseline: normals, an FPFH descriptor at every point, sample consensus initial alignment (SAC-IA),
// ICP. Source: R. B. Rusu, N. Blodow, M. Beetz, "Fast Point Feature Histograms (FPFH) for 3D Registration", section IV.
#ifndef CURVEREG_CORE_BASELINES_FPFH_SAC_IA_H_
#define CURVEREG_CORE_BASELINES_FPFH_SAC_IA_H_

#include "absl/status/statusor.h"
#include "core/baselines/baseline.h"
#include "core/scan/scan.h"

namespace curvereg {

// Descriptors, neighbour search and ICP are PCL's. The sampling loop is ours, because PCL's draws from rand(), which
// concurrent calls share, and cannot be interrupted. Scans without three described points each: OK, failure
// kTooFewFeatures. INVALID_ARGUMENT: a scan or an option that cannot be used; CANCELLED.
absl::StatusOr<BaselineResult> RegisterFpfhSacIa(const Scan& source, const Scan& target,
                                                 const BaselineOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASELINES_FPFH_SAC_IA_H_
