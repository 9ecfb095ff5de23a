// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/damage_record.h"

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "wire/error.h"

namespace curvereg::server {

bool DamageRecord::Contains(const std::string& scan_id) const {
  const std::lock_guard lock(mutex_);
  return ids_.contains(scan_id);
}

std::vector<std::string> DamageRecord::Ids() const {
  const std::lock_guard lock(mutex_);
  return {ids_.begin(), ids_.end()};
}

void DamageRecord::Add(const std::string& scan_id) {
  const std::lock_guard lock(mutex_);
  ids_.insert(scan_id);
}

void DamageRecord::Remove(const std::string& scan_id) {
  const std::lock_guard lock(mutex_);
  ids_.erase(scan_id);
}

absl::Status DamageRecord::AddPayload(const std::string& digest) {
  const absl::StatusOr<std::vector<std::string>> scans = catalog_.ScansWithPayload(digest);
  if (!scans.ok()) return scans.status();
  const std::lock_guard lock(mutex_);
  ids_.insert(scans->begin(), scans->end());
  return absl::OkStatus();
}

absl::Status DamageRecord::RemovePayload(const std::string& digest) {
  const absl::StatusOr<std::vector<std::string>> scans = catalog_.ScansWithPayload(digest);
  if (!scans.ok()) return scans.status();
  const std::lock_guard lock(mutex_);
  for (const std::string& id : *scans) ids_.erase(id);
  return absl::OkStatus();
}

absl::Status DamageRecord::Found(const StoredScan& scan) {
  const absl::Status added = AddPayload(scan.payload_digest.value());
  return added.ok() ? Error(scan.id) : added;
}

absl::Status DamageRecord::Error(const std::string& scan_id) {
  return wire::MakeError(v1::ERROR_REASON_STORED_SCAN_DAMAGED,
                         absl::StrCat("the stored bytes of ", scan_id, " are damaged; upload it again"));
}

}  // namespace curvereg::server
