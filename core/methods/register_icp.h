// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The method `icp`: refinement alone, from the prior (identity when none is given), judged like any other pose.
#ifndef CURVEREG_CORE_METHODS_REGISTER_ICP_H_
#define CURVEREG_CORE_METHODS_REGISTER_ICP_H_

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/methods/prepared_scan.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"

namespace curvereg {

// Errors as RegisterScans. Uses the threads of the innermost WithThreadLimit.
absl::StatusOr<RegistrationResult> RegisterIcp(const PreparedScan& source, const PreparedScan& target,
                                               const RegistrationOptions& options, const Stop& stop);

}  // namespace curvereg

#endif  // CURVEREG_CORE_METHODS_REGISTER_ICP_H_
