// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// START HERE. The whole method: two scans in, a rigid transform and its evidence out.
#ifndef CURVEREG_CORE_REGISTER_SCANS_H_
#define CURVEREG_CORE_REGISTER_SCANS_H_

#include "absl/status/statusor.h"
#include "core/registration_options.h"
#include "core/registration_result.h"
#include "core/scan.h"

namespace curvereg {

// The rigid transform that lays `source` on `target`, T_target_source, with verdict and evidence.
// Scans that do not match are an answer (OK, verdict rejected). INVALID_ARGUMENT: a scan or an option that cannot be
// used (see ValidateScan); CANCELLED: options.cancellation was requested. Deterministic, see RegistrationOptions::seed.
absl::StatusOr<RegistrationResult> RegisterScans(const Scan& source, const Scan& target,
                                                 const RegistrationOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_REGISTER_SCANS_H_
