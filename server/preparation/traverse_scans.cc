// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/preparation/traverse_scans.h"

#include <optional>

#include "server/preparation/registration_input.h"
#include "wire/error.h"
#include "wire/resource_names.h"

namespace curvereg::server {

bool IsLasting(const absl::Status& status) {
  if (status.ok() || absl::IsCancelled(status) || absl::IsDeadlineExceeded(status)) return false;
  const std::optional<v1::ErrorReason> reason = wire::ReasonOf(status);
  return reason != v1::ERROR_REASON_MEMORY_BUDGET && reason != v1::ERROR_REASON_STORAGE_FAULT &&
         reason != v1::ERROR_REASON_STORAGE_FULL && !absl::IsInternal(status);
}

TraverseScans::~TraverseScans() {
  for (const std::string& name : used_) sources_.cache->UpdateSize(name);
}

absl::StatusOr<std::shared_ptr<const PreparedScan>> TraverseScans::Load(const std::string& scan_id, const Stop& stop) {
  const absl::StatusOr<RegistrationInput> scan = RegistrationInput::OfStored(scan_id, "scan", sources_);
  if (!scan.ok()) return scan.status();
  const absl::StatusOr<MemoryBudget::Reservation> reservation = sources_.memory->Reserve(scan->MemoryBytes());
  if (!reservation.ok()) return reservation.status();
  absl::StatusOr<std::shared_ptr<const PreparedScan>> prepared = scan->Prepare(stop);
  if (prepared.ok()) {
    const std::lock_guard lock(mutex_);
    used_.insert(wire::ScanName(scan_id));
  }
  return prepared;
}

}  // namespace curvereg::server
