// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The method `curvelet`: hypotheses from bird's-eye curvelet features, refinement, verification; escalation from the
// cheap common case (elevation view) to more views and verticals while its confidence is low.
#ifndef CURVEREG_CORE_METHODS_REGISTER_CURVELET_H_
#define CURVEREG_CORE_METHODS_REGISTER_CURVELET_H_

#include "absl/status/statusor.h"
#include "core/methods/prepared_scan.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"

namespace curvereg {

// INVALID_ARGUMENT / CANCELLED as RegisterScans. Uses the threads of the innermost WithThreadLimit.
absl::StatusOr<RegistrationResult> RegisterCurvelet(const PreparedScan& source, const PreparedScan& target,
                                                    const RegistrationOptions& options, const Stop& stop);

}  // namespace curvereg

#endif  // CURVEREG_CORE_METHODS_REGISTER_CURVELET_H_
