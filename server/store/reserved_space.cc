// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/reserved_space.h"

#include <cstdint>

#include "absl/status/statusor.h"
#include "server/store/store_file.h"

namespace curvereg::server {
namespace {

// Of the databases' logs. The deletion of a scan takes some ten pages, that of a traverse 1 kB for each of its scans.
constexpr uint64_t kReservedBytes = uint64_t{16} << 20;

}  // namespace

absl::Status ReservedSpace::Use(const std::function<absl::Status()>& work) {
  const std::lock_guard lock(mutex_);
  absl::Status status = work();
  if (absl::IsResourceExhausted(status)) {
    GiveUp();
    status = work();
  }
  Take();
  return status;
}

void ReservedSpace::Take() {
  absl::StatusOr<StoreFile> file = StoreFile::OpenToWrite(path_);
  if (!file.ok()) return;
  const absl::StatusOr<uint64_t> size = file->Size();
  if (size.ok() && *size == kReservedBytes) return;
  // Half of it taken from a disk that is full would be too little for us and missing for others.
  if (!file->Allocate(kReservedBytes).ok()) GiveUp();
}

void ReservedSpace::GiveUp() { static_cast<void>(RemoveFile(path_)); }

}  // namespace curvereg::server
