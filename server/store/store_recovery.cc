// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/store_recovery.h"

#include <limits>
#include <optional>
#include <vector>

#include "server/store/page_token.h"
#include "server/store/scan_identity.h"

namespace curvereg::server {

absl::StatusOr<RecoveryReport> StoreRecovery::Recover() {
  for (int64_t before = std::numeric_limits<int64_t>::max();;) {
    const absl::StatusOr<std::vector<CatalogedScan>> scans = folder_.catalog->ListScans(before, kMaxPageSize);
    if (!scans.ok()) return scans.status();
    if (scans->empty()) break;
    for (const CatalogedScan& scan : *scans) RecoverScan(scan.scan);
    before = scans->back().sequence;
  }
  const auto set_aside = [this](const std::string& path, const std::string& name) { return SetAside(path, name); };
  if (absl::Status status = uploads_.Load(shared_, set_aside); !status.ok()) return status;
  if (absl::Status status = SetOrphansAside(); !status.ok()) return status;
  return RecoveryReport{folder_.orphaned.num_taken(), uploads_.emptied()};
}

void StoreRecovery::RecoverScan(const StoredScan& scan) {
  const std::string& digest = scan.payload_digest.value();
  space_.AddScan();
  if (payloads_.insert(digest).second) space_.AddPayload(scan.payload_bytes);
  const std::optional<FileInfo> file = folder_.payloads.LookAt(digest);
  if (file.has_value() && file->num_names > 1) shared_.insert(file->identity);
  // The id vouches for header and digest.
  const bool is_intact =
      scan.id == ScanId(scan.header, scan.payload_digest) && file.has_value() && file->bytes == scan.payload_bytes;
  if (!is_intact) damaged_.Add(scan.id);
}

// A payload without a row is either an upload still, whose commit was interrupted, or was about to be removed. Anything
// else had a row when it was acknowledged.
absl::Status StoreRecovery::SetOrphansAside() {
  const absl::StatusOr<std::vector<std::string>> digests = folder_.payloads.List();
  if (!digests.ok()) return digests.status();
  const std::set<FileIdentity> uploads = uploads_.Files();
  for (const std::string& digest : *digests) {
    if (payloads_.contains(digest)) continue;
    const std::optional<FileInfo> file = folder_.payloads.LookAt(digest);
    if (!file.has_value()) continue;
    const std::string path = folder_.payloads.PathOf(digest);
    const bool is_left_over =
        uploads.contains(file->identity) || folder_.removals.IsSet(path, StoreFolder::LabelOf(digest));
    const absl::Status status =
        is_left_over ? folder_.payloads.Remove(digest) : SetAside(path, StoreFolder::LabelOf(digest));
    if (!status.ok()) return status;
  }
  return folder_.removals.ClearAll();
}

absl::Status StoreRecovery::SetAside(const std::string& path, const std::string& name) {
  return folder_.reserved.Use([&] { return folder_.orphaned.Take(path, name); });
}

}  // namespace curvereg::server
