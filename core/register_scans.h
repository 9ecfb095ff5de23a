// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// START HERE. Two scans in, a rigid transform and its evidence out. core/README.md lists the stages in order; the
// method `curvelet` itself is one screen: CurveletRegistration::Run in methods/register_curvelet.cc.
#ifndef CURVEREG_CORE_REGISTER_SCANS_H_
#define CURVEREG_CORE_REGISTER_SCANS_H_

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/methods/prepared_scan.h"
#include "core/methods/registration_names.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"
#include "core/scan/scan.h"

namespace curvereg {

// The rigid transform T_target_source that aligns `source` to `target`, with verdict and evidence.
// Scans that do not match are an answer (OK, verdict rejected). INVALID_ARGUMENT: a scan or an option that cannot be
// used (see ValidateScan); CANCELLED: options.cancellation was requested; UNIMPLEMENTED: a method that this build
// leaves out. Same scans, options and seed: same bytes at any thread count, times apart.
absl::StatusOr<RegistrationResult> RegisterScans(const Scan& source, const Scan& target,
                                                 const RegistrationOptions& options = {});

// The same for scans prepared before: costs what the pair costs.
absl::StatusOr<RegistrationResult> RegisterPreparedScans(const PreparedScan& source, const PreparedScan& target,
                                                         const RegistrationOptions& options = {});

// The same for scans that these two prepare, at once and within the options' limits on threads and time; a stage of its
// own in the result. Out of time there: no pose and Reason::kDeadline, without counts and digests of the scans. Errors
// of the two, too; INVALID_ARGUMENT: the method prepares nothing (all but curvelet and icp).
using ScanPreparation = std::function<absl::StatusOr<std::shared_ptr<const PreparedScan>>(const Stop& stop)>;
absl::StatusOr<RegistrationResult> PrepareAndRegister(const ScanPreparation& source, const ScanPreparation& target,
                                                      const RegistrationOptions& options = {});

// When a registration that begins at `start` must end: the earlier of the options' deadline and time budget, and their
// cancellation.
Stop StopOf(const RegistrationOptions& options, std::chrono::steady_clock::time_point start);

// False: RegisterScans answers UNIMPLEMENTED, for this build leaves the method out.
bool IsAvailable(Method method);

// Name, version and compiler of this build.
std::string BuildId();

}  // namespace curvereg

#endif  // CURVEREG_CORE_REGISTER_SCANS_H_
