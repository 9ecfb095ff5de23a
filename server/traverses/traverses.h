// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The traverses that a server keeps: what was acknowledged is on disk, what is computed from it goes through the worker
// pool, and all that happens is an event with a number, kept and told to those who watch. Safe to use from several
// threads; nothing here waits for a registration.
#ifndef CURVEREG_SERVER_TRAVERSES_TRAVERSES_H_
#define CURVEREG_SERVER_TRAVERSES_TRAVERSES_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/mapping/trajectory.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/operations/logging.h"
#include "server/operations/metrics.h"
#include "server/preparation/prepared_scan_cache.h"
#include "server/scheduling/memory_budget.h"
#include "server/scheduling/worker_pool.h"
#include "server/settings/server_config.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

// All outlive the traverses.
struct TraverseEnvironment {
  LimitsConfig limits;
  ScanStore* store = nullptr;
  MemoryBudget* memory = nullptr;
  PreparedScanCache* cache = nullptr;
  WorkerPool* pool = nullptr;       // registrations
  WorkerPool* disk_pool = nullptr;  // reading and decoding
  Metrics* metrics = nullptr;
  Logger* logger = nullptr;
};

// The right to add scans to a traverse, until another stream of the same traverse is begun.
struct StreamTicket {
  std::string traverse_id;
  uint64_t fencing_number = 0;
  uint64_t next_sequence_number = 0;  // least one not yet acknowledged
  uint32_t reorder_window = 0;
};

class Traverses {
 public:
  // The database `traverses.sqlite` of the data directory; scans that were acknowledged but not registered when the
  // last process died are queued. Errors as ScanStore::Open.
  static absl::StatusOr<std::unique_ptr<Traverses>> Open(const std::string& data_dir,
                                                         const TraverseEnvironment& environment);
  virtual ~Traverses() = default;  // Close
  // Cancels what runs and waits for it; what is not done is done after the next Open. Nothing can be changed after it.
  virtual void Close() = 0;

  // INVALID_FIELD, TRAVERSE_EXISTS, TOO_MANY_TRAVERSES; all that take a name: TRAVERSE_NOT_FOUND.
  virtual absl::StatusOr<v1::Traverse> Create(const v1::CreateTraverseRequest& request) = 0;
  virtual absl::StatusOr<v1::Traverse> Get(const std::string& name) = 0;
  virtual absl::StatusOr<v1::ListTraversesResponse> List(const v1::ListTraversesRequest& request) = 0;
  virtual absl::StatusOr<v1::GetTrajectoryResponse> GetTrajectory(const v1::GetTrajectoryRequest& request) = 0;
  // Cancels what runs; scans that nothing else uses go, too, and what came of the next one. Who streams or watches
  // finds TRAVERSE_NOT_FOUND. STORAGE_FULL, STORAGE_FAULT: it is still there.
  virtual absl::Status Delete(const std::string& name) = 0;

  // Fences off the stream before; `owner` is requested to stop when the next one fences off this one.
  virtual absl::StatusOr<StreamTicket> BeginStream(const std::string& name, const std::stop_source& owner) = 0;
  // Whether that sequence number may be sent now: OK (also for one that is there with the same payload, which `known`
  // then tells), SEQUENCE_OUT_OF_RANGE (beyond the window), SEQUENCE_DIFFERS (there, another payload),
  // WRITER_REPLACED.
  virtual absl::Status CheckScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) = 0;
  // The payload is a stored scan: makes it part of the traverse, durably, and queues its registration; the same again
  // changes nothing. Errors as CheckScan, STORAGE_FAULT, STORAGE_FULL. Returns the least number not yet acknowledged.
  virtual absl::StatusOr<uint64_t> AddScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                           const std::string& scan_id) = 0;

  // Events from `first_event` on, as many as there are up to `max_events`. OFFSET_OUT_OF_RANGE: beyond the next one.
  virtual absl::StatusOr<std::vector<v1::WatchTraverseResponse>> Events(const std::string& name, uint64_t first_event,
                                                                        int max_events) = 0;
  // Results (events of that kind) of sequence numbers from `first_sequence_number` on, in order, up to `max_results`.
  virtual absl::StatusOr<std::vector<v1::ScanResult>> Results(const std::string& name, uint64_t first_sequence_number,
                                                              int max_results) = 0;
  // Calls `wake` (quick, must not call back into here) after every new event and at deletion, until the subscription is
  // destroyed, which waits for a call under way.
  class Subscription {
   public:
    virtual ~Subscription() = default;
  };
  virtual absl::StatusOr<std::unique_ptr<Subscription>> Subscribe(const std::string& name,
                                                                  std::function<void()> wake) = 0;

  // Waits its turn in the worker pool; `done` is called once: on a worker's thread, at once on refusal, or by Close and
  // Delete.
  using OptimizeDone = std::function<void(absl::StatusOr<v1::OptimizeTraverseResponse>)>;
  virtual void Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client, const Stop& stop,
                        OptimizeDone done) = 0;

  // What a map is made of: the scans of a segment in the newest version of the trajectory.
  struct MapSource {
    uint64_t version = 0;
    std::vector<std::string> scan_ids;
    std::vector<RigidTransform> T_segment_scan;
  };
  virtual absl::StatusOr<MapSource> SourceOfMap(const std::string& name, uint32_t segment) = 0;

  // Deletes a stored scan, as DeleteStoredScan does. SCAN_IN_USE; errors of ScanStore::DeleteScan.
  virtual absl::Status DeleteScan(const std::string& scan_id) = 0;

  virtual uint64_t num_traverses() = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRAVERSES_TRAVERSES_H_
