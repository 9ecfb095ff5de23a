// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The database of traverses: what was acknowledged and what was told. Each function that changes something is one
// transaction, forced to disk when it answers OK. Safe to use from several threads; readers do not wait for changes to
// reach the disk. Errors are STORAGE_FULL and STORAGE_FAULT.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_STORE_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_STORE_H_

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/mapping/trajectory.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/store/sqlite_database.h"

namespace curvereg::server {

// A traverse but for its scans, poses, links and events.
struct TraverseRecord {
  int64_t number = 0;           // in the order of creation; never used again
  v1::Traverse traverse;        // as it is told
  uint64_t fencing_number = 0;  // of the stream that may add scans; unique among all traverses
  uint64_t num_events = 0;
  int num_segments_begun = 0;      // numbers of ended ones are not used again
  uint64_t num_linked_scans = 0;   // those before this one had their further links looked for
  uint64_t num_links = 0;          // found so far
  uint64_t num_revised_links = 0;  // found when poses were revised last
  uint64_t num_revised_scans = 0;  // registered by then
};

// A scan that was acknowledged.
struct AcknowledgedScan {
  v1::StreamedScanHeader header;
  std::string scan_id;
  int64_t time_ns = 0;  // of the acknowledgement, since 1970
};

// A link, accepted or not.
struct StoredLink {
  uint64_t source = 0;  // sequence numbers
  uint64_t target = 0;
  LinkKind kind = LinkKind::kTracking;
  v1::RegistrationResult result;
};

// What a piece of work on a traverse came to. Poses replace those of the same scan; links and events go after those
// that are there.
struct TraverseStep {
  std::vector<v1::TrajectoryPose> poses;
  std::vector<StoredLink> links;
  std::vector<v1::WatchTraverseResponse> events;
};

// Poses of one version of the trajectory, by sequence number.
struct StoredPoses {
  v1::Traverse traverse;
  std::vector<v1::TrajectoryPose> poses;
};

class TraverseStore {
 public:
  // `may_be_new`: an empty database, or none, is a new one. Errors as ScanCatalog::Open.
  static absl::StatusOr<std::unique_ptr<TraverseStore>> Open(const std::string& path, bool may_be_new);

  absl::StatusOr<std::vector<TraverseRecord>> Traverses();  // by number
  // Adds it and gives it its number.
  absl::Status AddTraverse(TraverseRecord& record);
  // The scans that nothing else uses then are to be deleted, too: see PendingDeletions.
  absl::Status RemoveTraverse(int64_t number);
  // Gives the record a new fencing number, greater than any before.
  absl::Status Fence(TraverseRecord& record);

  absl::Status AddScan(const TraverseRecord& record, const AcknowledgedScan& scan);
  absl::StatusOr<std::optional<AcknowledgedScan>> FindScan(int64_t number, uint64_t sequence_number);
  // From `first` on, by sequence number, at most `max_scans`.
  absl::StatusOr<std::vector<AcknowledgedScan>> Scans(int64_t number, uint64_t first, int64_t max_scans);
  absl::StatusOr<bool> IsScanUsed(const std::string& scan_id);
  // Scans of removed traverses that nothing used then, to be deleted from the store of scans; until CancelDeletion.
  absl::StatusOr<std::vector<std::string>> PendingDeletions();
  absl::Status CancelDeletion(const std::string& scan_id);

  // `record` as it is after the step.
  absl::Status AddStep(const TraverseRecord& record, const TraverseStep& step);
  static constexpr int64_t kAll = std::numeric_limits<int64_t>::max();
  // From `first` on, at most `max_poses`. `traverse` is of the same moment.
  absl::StatusOr<StoredPoses> Poses(int64_t number, uint64_t first, int64_t max_poses);
  absl::StatusOr<std::vector<StoredLink>> Links(int64_t number);
  absl::StatusOr<std::vector<v1::WatchTraverseResponse>> Events(int64_t number, uint64_t first, int64_t max_events);
  absl::StatusOr<std::vector<v1::ScanResult>> Results(int64_t number, uint64_t first_sequence_number,
                                                      int64_t max_results);

 private:
  TraverseStore(SqliteDatabase writer, SqliteDatabase reader);
  // One transaction. Within it: each statement with these values.
  absl::Status Change(const std::function<absl::Status()>& change);
  absl::Status Run(std::initializer_list<std::string_view> statements, const std::vector<SqlValue>& values);
  absl::Status PutRecord(const TraverseRecord& record);
  absl::Status PutStep(const TraverseRecord& record, const TraverseStep& step);

  std::mutex writer_mutex_;
  SqliteDatabase writer_;
  std::mutex reader_mutex_;
  SqliteDatabase reader_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_STORE_H_
