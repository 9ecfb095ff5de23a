// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The traverses that a server keeps, by name. Safe to use from several threads; nothing here waits for a registration.
#ifndef CURVEREG_SERVER_TRAVERSES_TRAVERSES_H_
#define CURVEREG_SERVER_TRAVERSES_TRAVERSES_H_

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/operations/logging.h"
#include "server/preparation/scan_sources.h"
#include "server/scheduling/worker_pool.h"
#include "server/tracking/tracked_traverse.h"

namespace curvereg::server {

// All outlive the traverses.
struct TraverseEnvironment {
  ScanSources scans;           // with a store
  WorkerPool* pool = nullptr;  // of registrations
  Logger* logger = nullptr;    // null: no lines
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

  // INVALID_FIELD, TRAVERSE_EXISTS, TOO_MANY_TRAVERSES.
  virtual absl::StatusOr<v1::Traverse> Create(const v1::CreateTraverseRequest& request) = 0;
  // For one call: who keeps it longer does not see that the traverse was deleted, and made again. TRAVERSE_NOT_FOUND;
  // INVALID_FIELD "name".
  virtual absl::StatusOr<std::shared_ptr<TrackedTraverse>> Find(const std::string& name) = 0;
  virtual absl::StatusOr<v1::ListTraversesResponse> List(const v1::ListTraversesRequest& request) = 0;
  // Cancels what runs; scans that nothing else uses go, too, and what came of the next one. Who streams or watches
  // finds TRAVERSE_NOT_FOUND. STORAGE_FULL, STORAGE_FAULT: it is still there. Other errors as Find.
  virtual absl::Status Delete(const std::string& name) = 0;

  // Deletes a stored scan, as DeleteStoredScan does. SCAN_IN_USE; errors of ScanStore::DeleteScan.
  virtual absl::Status DeleteScan(const std::string& scan_id) = 0;

  virtual uint64_t num_traverses() = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRAVERSES_TRAVERSES_H_
