// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/scan_reader.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/store/page_token.h"
#include "server/store/scan_identity.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr uint64_t kCheckedBytes = uint64_t{1} << 20;  // read at once
constexpr int64_t kNewest = std::numeric_limits<int64_t>::max();

}  // namespace

absl::StatusOr<std::optional<StoredScan>> ScanReader::FindScan(const UploadDescription& description) {
  const v1::Digest digest = description.payload_digest.value_or(v1::Digest());
  if (digest.algorithm() != v1::DIGEST_ALGORITHM_XXH3_128) return std::optional<StoredScan>();
  const std::string id = ScanId(description.header, digest);
  absl::StatusOr<std::optional<StoredScan>> scan = folder_.catalog->FindScan(id);
  // A damaged one is repaired by sending it again.
  if (scan.ok() && scan->has_value() &&
      ((*scan)->payload_bytes != description.payload_bytes || damaged_.Contains(id))) {
    return std::optional<StoredScan>();
  }
  return scan;
}

absl::StatusOr<std::string> ScanReader::ReadPayload(const std::string& scan_id, uint64_t offset, uint64_t size) {
  const absl::StatusOr<StoredScan> scan = folder_.catalog->GetScan(scan_id);
  if (!scan.ok()) return scan.status();
  if (damaged_.Contains(scan_id)) return DamageRecord::Error(scan_id);
  if (offset > scan->payload_bytes) {
    return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "the offset lies beyond the end of the payload",
                           {{"payload_bytes", absl::StrCat(scan->payload_bytes)}});
  }
  const std::string& digest = scan->payload_digest.value();
  const uint64_t wanted = std::min(size, scan->payload_bytes - offset);
  absl::StatusOr<std::string> bytes = folder_.payloads.Read(digest, offset, wanted);
  if (bytes.ok() && bytes->size() == wanted) return bytes;
  // Deleted meanwhile, damaged, or a fault that passes?
  if (const absl::StatusOr<StoredScan> again = folder_.catalog->GetScan(scan_id); !again.ok()) return again.status();
  if (bytes.ok() || !folder_.payloads.HasSize(digest, scan->payload_bytes)) return damaged_.Found(*scan);
  return bytes;
}

absl::StatusOr<std::string> ScanReader::ReadWholePayload(const std::string& scan_id) {
  const absl::StatusOr<StoredScan> scan = folder_.catalog->GetScan(scan_id);
  if (!scan.ok()) return scan.status();
  absl::StatusOr<std::string> bytes = ReadPayload(scan_id, 0, scan->payload_bytes);
  if (!bytes.ok() || wire::SameDigest(wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, *bytes), scan->payload_digest)) {
    return bytes;
  }
  return damaged_.Found(*scan);
}

absl::StatusOr<ScanPage> ScanReader::ListScans(int page_size, const std::string& page_token) {
  const absl::StatusOr<int64_t> before = PlaceOf(page_token, kNewest);
  if (!before.ok()) return before.status();
  const int num_wanted = std::clamp(page_size, 1, kMaxPageSize);
  absl::StatusOr<std::vector<CatalogedScan>> scans = folder_.catalog->ListScans(*before, num_wanted + 1);
  if (!scans.ok()) return scans.status();
  ScanPage page;
  if (scans->size() > static_cast<std::size_t>(num_wanted)) {
    scans->pop_back();
    page.next_page_token = TokenOfPlace(scans->back().sequence);
  }
  for (CatalogedScan& scan : *scans) page.scans.push_back(std::move(scan.scan));
  return page;
}

absl::Status ScanReader::CheckScan(const std::string& scan_id) {
  const absl::StatusOr<StoredScan> scan = folder_.catalog->GetScan(scan_id);
  if (!scan.ok()) return scan.status();
  absl::StatusOr<wire::Digester> digester = wire::Digester::Create(v1::DIGEST_ALGORITHM_XXH3_128);
  if (!digester.ok()) return digester.status();
  for (uint64_t offset = 0; offset < scan->payload_bytes; offset += kCheckedBytes) {
    const absl::StatusOr<std::string> piece = ReadPayload(scan_id, offset, kCheckedBytes);
    if (!piece.ok()) return piece.status();
    digester->Update(*piece);
  }
  return wire::SameDigest(digester->Digest(), scan->payload_digest) ? absl::OkStatus() : damaged_.Found(*scan);
}

}  // namespace curvereg::server
