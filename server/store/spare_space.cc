// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/spare_space.h"

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/store_file.h"

namespace curvereg::server {
namespace {

// Of the databases' logs. The deletion of a scan takes some ten pages, that of a traverse 1 kB for each of its scans.
constexpr uint64_t kSpareBytes = uint64_t{16} << 20;

}  // namespace

void SpareSpace::Take() {
  absl::StatusOr<StoreFile> file = StoreFile::OpenToWrite(path_);
  if (!file.ok()) return;
  const absl::StatusOr<uint64_t> size = file->Size();
  if (size.ok() && *size == kSpareBytes) return;
  // Half of it taken from a disk that is full would be too little for us and missing for others.
  if (!file->Allocate(kSpareBytes).ok()) GiveUp();
}

void SpareSpace::GiveUp() { static_cast<void>(RemoveFile(path_)); }

}  // namespace curvereg::server
