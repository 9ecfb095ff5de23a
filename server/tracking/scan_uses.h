// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which stored scans traverses use. A scan in use is not deleted; the scans of a deleted traverse that nothing else
// uses are.
#ifndef CURVEREG_SERVER_TRACKING_SCAN_USES_H_
#define CURVEREG_SERVER_TRACKING_SCAN_USES_H_

#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "server/preparation/prepared_scan_cache.h"
#include "server/store/scan_store.h"
#include "server/tracking/traverse_store.h"

namespace curvereg::server {

// Safe to use from several threads.
class ScanUses {
 public:
  // All outlive it. `scans` and `cache`: where the scans are deleted.
  ScanUses(TraverseStore* traverses, ScanStore* scans, PreparedScanCache* cache)
      : traverses_(traverses), scans_(scans), cache_(cache) {}

  // Held from the check that a scan is stored until it is part of a traverse: meanwhile no scan is deleted.
  std::unique_lock<std::mutex> Lock() { return std::unique_lock(mutex_); }

  // SCAN_IN_USE; errors of ScanStore::DeleteScan.
  absl::Status DeleteScan(const std::string& scan_id);
  // Deletes the scans that deleted traverses left behind. Those that remain, because of a fault of the disk, are
  // deleted by a later call. Takes the lock for one scan at a time, so that no stream waits for hundreds.
  void DeletePending();

 private:
  void DeletePendingScan(const std::string& scan_id);

  TraverseStore* const traverses_;
  ScanStore* const scans_;
  PreparedScanCache* const cache_;
  std::mutex mutex_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_SCAN_USES_H_
