// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Traverses between the core and the contract. Poses and links are kept as messages, so the core works with what comes
// out of them again: then a restarted server continues with the same numbers.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_CONVERSION_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_CONVERSION_H_

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/mapping/tracking.h"
#include "core/mapping/trajectory.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/tracking/traverse_store.h"

namespace curvereg::server {

absl::Status TraverseNotFound(const std::string& name);  // TRAVERSE_NOT_FOUND
absl::Status TraverseClosed();                           // CANCELLED

// How a traverse of these settings is tracked. INVALID_FIELD, METHOD_UNAVAILABLE; fields within the settings.
absl::StatusOr<TrackingOptions> FromWire(const v1::TraverseSettings& settings, int max_threads);

// What a header says beside the payload. INVALID_FIELD; fields within the header.
absl::StatusOr<std::optional<Prior>> PriorOf(const v1::StreamedScanHeader& header);
std::optional<int64_t> TimeOf(const v1::StreamedScanHeader& header);  // [ns] since 1970

v1::TraverseLink ToWire(const TraverseLink& link);

// Without its times; what cannot be told (a covariance that is none) is left out.
StoredLink ToStored(const TraverseLink& link);
absl::StatusOr<TraverseLink> FromStored(const StoredLink& link);  // INVALID_FIELD

v1::ScanResult ToWire(const TrackedScan& tracked);  // without the latency
v1::SegmentsJoined ToWire(const SegmentJoin& join);

// Length of the path within segments [m]: between poses of one segment that follow each other.
double PathLength(const Traverse& traverse);
int CountSegments(const Traverse& traverse);  // those that have poses

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_CONVERSION_H_
