// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/scan_uses.h"

#include <vector>

#include "absl/status/statusor.h"
#include "server/preparation/scan_deletion.h"
#include "wire/error.h"

namespace curvereg::server {

absl::Status ScanUses::DeleteScan(const std::string& scan_id) {
  const std::lock_guard lock(mutex_);
  const absl::StatusOr<bool> is_used = traverses_->IsScanUsed(scan_id);
  if (!is_used.ok()) return is_used.status();
  if (*is_used) return wire::MakeError(v1::ERROR_REASON_SCAN_IN_USE, "a traverse uses the scan; delete that first");
  return DeleteStoredScan(scan_id, *scans_, *cache_);
}

void ScanUses::DeletePending() {
  const absl::StatusOr<std::vector<std::string>> scans = traverses_->PendingDeletions();
  if (!scans.ok()) return;
  for (const std::string& id : *scans) DeletePendingScan(id);
}

void ScanUses::DeletePendingScan(const std::string& scan_id) {
  const std::lock_guard lock(mutex_);
  const absl::StatusOr<bool> is_used = traverses_->IsScanUsed(scan_id);
  if (!is_used.ok() || *is_used) return;  // part of another traverse meanwhile
  const absl::Status deleted = DeleteStoredScan(scan_id, *scans_, *cache_);
  if (!deleted.ok() && wire::ReasonOf(deleted) != v1::ERROR_REASON_SCAN_NOT_FOUND) return;
  traverses_->CancelDeletion(scan_id).IgnoreError();
}

}  // namespace curvereg::server
