// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/register_scans.h"

#include "core/parallel.h"
#include "core/register_curvelet.h"

namespace curvereg {

absl::StatusOr<RegistrationResult> RegisterScans(const Scan& source, const Scan& target,
                                                 const RegistrationOptions& options) {
  if (absl::Status status = ValidateScan(source, options.limits); !status.ok()) return status;
  if (absl::Status status = ValidateScan(target, options.limits); !status.ok()) return status;
  absl::StatusOr<RegistrationResult> result = absl::UnknownError("not run");
  WithThreadLimit(options.num_threads, [&] {
    std::unique_ptr<PreparedScan> prepared[2];
    ParallelFor(2, [&](int i) {
      const Scan& scan = i == 0 ? source : target;
      prepared[i] = std::make_unique<PreparedScan>(std::shared_ptr<const Scan>(std::shared_ptr<void>(), &scan),
                                                   PreparationOptions{});
    });
    Stop stop; result = RegisterCurvelet(*prepared[0], *prepared[1], options, stop);
  });
  return result;
}

}  // namespace curvereg
