// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The services of scans and traverses within this process, over a real store: a traverse of two scans, a third scan
// and an unfinished upload.
#ifndef CURVEREG_FUZZ_CALLED_SERVICES_H_
#define CURVEREG_FUZZ_CALLED_SERVICES_H_

#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/server.h>

#include <filesystem>
#include <memory>
#include <string>

#include "core/scan/scan.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/access/access.h"
#include "server/maps/map_builder.h"
#include "server/operations/metrics.h"
#include "server/preparation/prepared_scan_cache.h"
#include "server/scans/scan_service.h"
#include "server/scheduling/memory_budget.h"
#include "server/scheduling/worker_pool.h"
#include "server/store/scan_store.h"
#include "server/traverses/traverse_service.h"
#include "server/traverses/traverses.h"

namespace curvereg::server {

// Aborts when it cannot be set up.
class CalledServices {
 public:
  CalledServices();

  grpc::GenericStub& stub() { return *stub_; }
  // Makes again what a call has deleted, and deletes what one has made.
  void Restore();

 private:
  std::string Keep(int number);  // the id of a scan
  void MakeTraverse();
  void MakeUpload();

  const std::filesystem::path folder_;
  Metrics metrics_;
  const std::unique_ptr<Access> access_ = Access::Open();
  MemoryBudget memory_{uint64_t{256} << 20};
  PreparedScanCache cache_{uint64_t{1} << 20};
  WorkerPool pool_{{.num_workers = 1}};
  WorkerPool disk_pool_{{.num_workers = 1}};
  std::unique_ptr<ScanStore> store_;
  std::unique_ptr<Traverses> traverses_;
  std::unique_ptr<MapBuilder> maps_;
  std::unique_ptr<ScanService> scan_service_;
  std::unique_ptr<TraverseService> traverse_service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<grpc::GenericStub> stub_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_FUZZ_CALLED_SERVICES_H_
