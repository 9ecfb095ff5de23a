// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What is computed for one traverse, on what the core knows of it. That is read from the database when it is needed
// and can be forgotten at any time. One thread at a time.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_WORK_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_WORK_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/mapping/tracking.h"
#include "server/preparation/traverse_scans.h"
#include "server/tracking/tracking_environment.h"
#include "server/tracking/traverse_store.h"

namespace curvereg::server {

class TraverseWork {
 public:
  // `environment` outlives it.
  TraverseWork(const TrackingEnvironment& environment, TrackingOptions options)
      : environment_(environment), options_(std::move(options)) {}

  // Reads the traverse unless it is there. Errors of the store.
  absl::Status Load(const TraverseRecord& record);
  bool is_loaded() const { return number_ != 0; }
  void Forget();

  // Each of these makes a step, to be kept in the database as a whole; where that fails, Forget. Events are without
  // number and time. An error leaves all as it was, and the same may be tried again. Precondition: loaded.

  // The next scan's pose. A scan that cannot be used gets one by its prior or begins a segment. `must_end`: so
  // does one that cannot be read for a fault that may pass.
  absl::StatusOr<TraverseStep> Track(const AcknowledgedScan& scan, bool must_end, const Stop& stop);
  // Further links of the next tracked scan that has none.
  absl::StatusOr<TraverseStep> LookAround(bool must_end, const Stop& stop);
  absl::StatusOr<TraverseStep> CloseLoops(const Stop& stop);
  struct Revised {
    TraverseStep step;
    TraverseRevision revision;
  };
  absl::StatusOr<Revised> Revise(const Stop& stop);

  // Links since the last revision join segments, or are many scans old.
  bool IsRevisionDue() const;

  // [s] Between the acquisitions of the last two tracked scans, by their times. 0: unknown, or the clock was set back.
  double LastAcquisitionSeconds() const;

  // The record after the steps so far, but for its events and what is acknowledged.
  void Describe(TraverseRecord& record) const;

 private:
  absl::Status ReadScans(const TraverseRecord& record);
  TraverseScanLoader Loader(TraverseScans& scans) const;
  TrackedScan Untracked(const TraverseScan& scan) const;
  TraverseStep AddTracked(TrackedScan tracked, const AcknowledgedScan& scan, const std::optional<Prior>& prior);
  TraverseStep AddLinks(const std::vector<TraverseLink>& links);
  std::vector<StoredLink> KeepLinks(std::vector<TraverseLink>& links) const;

  const TrackingEnvironment& environment_;
  const TrackingOptions options_;
  int64_t number_ = 0;
  std::string name_;
  bool optimizes_ = false;
  Traverse traverse_;
  std::vector<std::string> scan_ids_;  // of tracked scans
  uint64_t num_linked_scans_ = 0;
  uint64_t num_revised_links_ = 0;
  uint64_t num_revised_scans_ = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_WORK_H_
