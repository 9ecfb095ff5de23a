// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/link_registration.h"

#include <algorithm>

#include "core/base/stop_status.h"
#include "core/register_scans.h"

namespace curvereg {

absl::StatusOr<TraverseLink> RegisterLink(const PreparedScan& source, const LinkRequest& request,
                                          const TraverseScanLoader& load, const RegistrationOptions& options,
                                          const Stop& stop) {
  if (absl::Status status = StopStatus(stop, "work on the traverse"); !status.ok()) return status;
  const absl::StatusOr<std::shared_ptr<const PreparedScan>> target = load(request.target, stop);
  if (!target.ok()) return target.status();
  RegistrationOptions own = options;
  own.prior = request.prior;
  if (stop.cancellation.stop_possible()) own.cancellation = stop.cancellation;
  if (stop.deadline.has_value()) own.deadline = std::min(*stop.deadline, options.deadline.value_or(*stop.deadline));
  absl::StatusOr<RegistrationResult> result = RegisterPreparedScans(source, **target, own);
  if (!result.ok()) return result.status();
  if (absl::Status status = StopStatus(stop, "work on the traverse"); !status.ok()) return status;
  return TraverseLink{request.source, request.target, request.kind, *std::move(result)};
}

std::set<uint64_t> LinkedPartners(const Traverse& traverse, uint64_t sequence_number) {
  std::set<uint64_t> partners;
  for (const TraverseLink& link : traverse.links) {
    if (link.source == sequence_number) partners.insert(link.target);
    if (link.target == sequence_number) partners.insert(link.source);
  }
  return partners;
}

}  // namespace curvereg
