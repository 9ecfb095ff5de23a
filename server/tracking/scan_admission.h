// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which scans become part of a traverse. Only the stream that came last may add scans (fencing), and only the next
// sequence number or one that lies within the window beyond it.
#ifndef CURVEREG_SERVER_TRACKING_SCAN_ADMISSION_H_
#define CURVEREG_SERVER_TRACKING_SCAN_ADMISSION_H_

#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/tracking/tracking_environment.h"
#include "server/tracking/traverse_journal.h"
#include "server/tracking/traverse_types.h"

namespace curvereg::server {

// Safe to use from several threads.
class ScanAdmission {
 public:
  // `environment` outlives it; `early`: sequence numbers acknowledged beyond the next one.
  ScanAdmission(const TrackingEnvironment& environment, std::shared_ptr<TraverseJournal> journal,
                std::set<uint64_t> early);

  // As those of TrackedTraverse.
  absl::StatusOr<StreamTicket> BeginStream(const std::stop_source& owner);
  absl::Status CheckScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) const;
  absl::StatusOr<uint64_t> AddScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                   const std::string& scan_id);
  // Ends the stream under way, if any, with WRITER_REPLACED.
  void EndStream();

 private:
  // With the mutex held. OK also for a scan that is there, if it may be the same one: `known`.
  absl::Status Check(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) const;
  absl::Status CheckKnown(const TraverseRecord& record, const v1::StreamedScanHeader& header) const;
  absl::Status CheckNew(const TraverseRecord& record, const v1::StreamedScanHeader& header) const;
  absl::StatusOr<uint64_t> Acknowledge(const v1::StreamedScanHeader& header, const std::string& scan_id);
  absl::StatusOr<uint64_t> AcknowledgeAgain(uint64_t sequence_number, const std::string& scan_id) const;

  const TrackingEnvironment& environment_;
  const std::shared_ptr<TraverseJournal> journal_;
  const std::string name_;
  mutable std::mutex mutex_;
  std::set<uint64_t> early_;
  std::stop_source owner_{std::nostopstate};
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_SCAN_ADMISSION_H_
