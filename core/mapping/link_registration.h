// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One link of a traverse: which two scans, what is known beforehand, and the registration of them.
#ifndef CURVEREG_CORE_MAPPING_LINK_REGISTRATION_H_
#define CURVEREG_CORE_MAPPING_LINK_REGISTRATION_H_

#include <memory>
#include <optional>
#include <set>

#include "absl/status/statusor.h"
#include "core/mapping/tracking_options.h"
#include "core/mapping/trajectory.h"

namespace curvereg {

struct LinkRequest {
  uint64_t source = 0;  // sequence numbers; target < source
  uint64_t target = 0;
  LinkKind kind = LinkKind::kTracking;
  std::optional<Prior> prior;  // T_target_source
};

// Registers `source` on the target, which `load` gives, with the traverse's options but the request's prior. Running
// out of options.time_budget_s rejects the link; errors: CANCELLED and DEADLINE_EXCEEDED of `stop`, those of `load`
// (NOT_FOUND: the target is not kept) and of RegisterPreparedScans.
absl::StatusOr<TraverseLink> RegisterLink(const PreparedScan& source, const LinkRequest& request,
                                          const TraverseScanLoader& load, const RegistrationOptions& options,
                                          const Stop& stop);

// Scans that are not kept, or cannot be used, are passed over and others tried instead; after so many a search beside
// one scan ends, for each of them may have to be read.
inline constexpr int kMaxNotKept = 50;

// The scans that have a link with this one, accepted or not.
std::set<uint64_t> LinkedPartners(const Traverse& traverse, uint64_t sequence_number);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_LINK_REGISTRATION_H_
