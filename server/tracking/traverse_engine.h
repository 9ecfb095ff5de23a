// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One traverse at work: its record, the scans that are admitted, the work on them, and what is told of it.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_ENGINE_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_ENGINE_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/tracking/scan_admission.h"
#include "server/tracking/tracked_traverse.h"
#include "server/tracking/tracking_environment.h"
#include "server/tracking/traverse_journal.h"
#include "server/tracking/traverse_scheduler.h"
#include "server/tracking/traverse_watchers.h"

namespace curvereg::server {

class TraverseEngine final : public TrackedTraverse {
 public:
  // As the database has it; `environment` outlives it. Nothing is done before Start. INVALID_FIELD,
  // METHOD_UNAVAILABLE: the settings; errors of the database.
  static absl::StatusOr<std::shared_ptr<TraverseEngine>> Open(const TrackingEnvironment& environment,
                                                              const TraverseRecord& record,
                                                              std::shared_ptr<TraverseWatchers> watchers);

  // Has what is left from an earlier process done.
  void Start() { scheduler_->Schedule(); }
  // Cancels what runs and waits for it; nothing can be done after it, but what is there can be read.
  void Close();
  // Ends the stream under way, if any, with WRITER_REPLACED.
  void EndStream() { admission_.EndStream(); }

  TraverseRecord record() const { return journal_->record(); }
  const std::shared_ptr<TraverseWatchers>& watchers() const { return watchers_; }

  v1::Traverse Description() const override { return record().traverse; }
  absl::StatusOr<StreamTicket> BeginStream(const std::stop_source& owner) override;
  absl::Status CheckScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) override;
  absl::StatusOr<uint64_t> AddScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                   const std::string& scan_id) override;
  absl::StatusOr<std::vector<v1::WatchTraverseResponse>> Events(uint64_t first_event, int max_events) override;
  absl::StatusOr<std::vector<v1::ScanResult>> Results(uint64_t first_sequence_number, int max_results) override;
  std::unique_ptr<Subscription> Subscribe(std::function<void()> wake) override;
  absl::StatusOr<v1::GetTrajectoryResponse> Trajectory(int page_size, const std::string& page_token) override;
  absl::StatusOr<SegmentScans> ScansOfSegment(uint32_t segment) override;
  void Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client, const Stop& stop,
                OptimizeDone done) override;

 private:
  // What is known of a traverse beside its record when it is opened.
  struct Origin {
    std::set<uint64_t> early;  // sequence numbers acknowledged beyond the next one
    TrackingOptions options;
    std::shared_ptr<TraverseWatchers> watchers;
  };
  TraverseEngine(const TrackingEnvironment& environment, const TraverseRecord& record, Origin origin);

  const TrackingEnvironment& environment_;
  const std::shared_ptr<TraverseWatchers> watchers_;
  const std::shared_ptr<TraverseJournal> journal_;
  ScanAdmission admission_;
  const std::shared_ptr<TraverseScheduler> scheduler_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_ENGINE_H_
