// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a store does when it is opened: rows and files are compared.
#include <limits>
#include <utility>

#include "server/store/page_token.h"
#include "server/store/scan_identity.h"
#include "server/store/scan_store_impl.h"

namespace curvereg::server {

absl::Status ScanStoreImpl::LookOver() {
  Named named;
  for (int64_t before = std::numeric_limits<int64_t>::max();;) {
    const absl::StatusOr<std::vector<CatalogedScan>> scans = folder_.catalog->ListScans(before, kMaxPageSize);
    if (!scans.ok()) return scans.status();
    if (scans->empty()) break;
    for (const CatalogedScan& scan : *scans) LookOverScan(scan.scan, named);
    before = scans->back().sequence;
  }
  const auto set_aside = [this](const std::string& path, const std::string& name) { return SetAside(path, name); };
  if (absl::Status status = uploads_.Load(named.shared, set_aside); !status.ok()) return status;
  return SetOrphansAside(named);
}

void ScanStoreImpl::LookOverScan(const StoredScan& scan, Named& named) {
  const std::string& digest = scan.payload_digest.value();
  ++num_scans_;
  if (named.payloads.insert(digest).second) space_.AddPayload(scan.payload_bytes);
  const std::optional<FileInfo> file = folder_.payloads.LookAt(digest);
  if (file.has_value() && file->num_names > 1) named.shared.insert(file->identity);
  // The id vouches for header and digest.
  const bool is_intact =
      scan.id == ScanId(scan.header, scan.payload_digest) && file.has_value() && file->bytes == scan.payload_bytes;
  if (!is_intact) damaged_.insert(scan.id);
}

// A payload without a row is either an upload still, whose commit was interrupted, or was about to be removed. Anything
// else had a row when it was acknowledged.
absl::Status ScanStoreImpl::SetOrphansAside(const Named& named) {
  const absl::StatusOr<std::vector<std::string>> digests = folder_.payloads.List();
  if (!digests.ok()) return digests.status();
  const std::set<FileIdentity> uploads = uploads_.Files();
  for (const std::string& digest : *digests) {
    if (named.payloads.contains(digest)) continue;
    const std::optional<FileInfo> file = folder_.payloads.LookAt(digest);
    if (!file.has_value()) continue;
    const std::string path = folder_.payloads.PathOf(digest);
    const bool is_left_over = uploads.contains(file->identity) || folder_.removals.IsSet(path, LabelOf(digest));
    const absl::Status status = is_left_over ? folder_.payloads.Remove(digest) : SetAside(path, LabelOf(digest));
    if (!status.ok()) return status;
  }
  return folder_.removals.ClearAll();
}

absl::Status ScanStoreImpl::SetAside(const std::string& path, const std::string& name) {
  return WithSpareSpace([&] { return folder_.lost.Take(path, name); });
}

}  // namespace curvereg::server
