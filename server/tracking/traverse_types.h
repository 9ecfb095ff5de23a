// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What streams and calls exchange with a traverse.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_TYPES_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_TYPES_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"
#include "curvereg/v1/traverse_service.pb.h"

namespace curvereg::server {

// The right to add scans to a traverse, until another stream of the same traverse is begun.
struct StreamTicket {
  std::string traverse_id;
  uint64_t fencing_number = 0;
  uint64_t next_sequence_number = 0;  // least one not yet acknowledged
  uint32_t reorder_window = 0;
};

// Somebody is told of events until this is destroyed, which waits for a call under way.
class Subscription {
 public:
  virtual ~Subscription() = default;
};

using OptimizeDone = std::function<void(absl::StatusOr<v1::OptimizeTraverseResponse>)>;

// The tracked scans of one segment and their poses, as many of the one as of the other.
struct SegmentScans {
  uint64_t version = 0;  // of the trajectory
  std::vector<std::string> scan_ids;
  std::vector<RigidTransform> T_segment_scan;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_TYPES_H_
