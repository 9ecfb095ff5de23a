// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Prepared scans for a piece of work on a traverse, from the server's cache or prepared anew.
#ifndef CURVEREG_SERVER_PREPARATION_TRAVERSE_SCANS_H_
#define CURVEREG_SERVER_PREPARATION_TRAVERSE_SCANS_H_

#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/methods/prepared_scan.h"
#include "server/preparation/scan_sources.h"

namespace curvereg::server {

// False: the same may go well later (memory is reserved, a disk fault, cancelled).
bool IsLasting(const absl::Status& status);

// Safe to use from several threads.
class TraverseScans {
 public:
  // `sources` outlives it.
  explicit TraverseScans(const ScanSources& sources) : sources_(sources) {}
  ~TraverseScans();  // tells the cache how large they have grown
  TraverseScans(const TraverseScans&) = delete;
  TraverseScans& operator=(const TraverseScans&) = delete;

  // Reserves memory while it prepares. SCAN_NOT_FOUND, SCAN_TOO_LARGE, UNUSABLE_SCAN, MALFORMED_PAYLOAD,
  // STORED_SCAN_DAMAGED, MEMORY_BUDGET; CANCELLED, DEADLINE_EXCEEDED; errors of the store.
  absl::StatusOr<std::shared_ptr<const PreparedScan>> Load(const std::string& scan_id, const Stop& stop);

 private:
  const ScanSources& sources_;
  std::mutex mutex_;
  std::set<std::string> used_;  // names
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_PREPARATION_TRAVERSE_SCANS_H_
