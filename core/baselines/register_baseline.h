// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The paper's two baselines behind the interface of the other methods. They know no verdict of their own: a pose counts
// as accepted when their last step converged, which is all that they can say of themselves.
#ifndef CURVEREG_CORE_BASELINES_REGISTER_BASELINE_H_
#define CURVEREG_CORE_BASELINES_REGISTER_BASELINE_H_

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"

namespace curvereg {

// False: this build is one without PCL.
bool HasBaselines();

// Precondition: options.method is kFpfhSacIa or kHarris3dFpfh. Errors as RegisterScans; UNIMPLEMENTED in a build
// without PCL.
absl::StatusOr<RegistrationResult> RegisterBaseline(const Scan& source, const Scan& target,
                                                    const RegistrationOptions& options, const Stop& stop);

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASELINES_REGISTER_BASELINE_H_
