// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/streamed_upload.h"

#include <memory>

#include "absl/strings/str_cat.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {

std::string StreamedUploadId(const std::string& traverse_id, uint64_t sequence_number) {
  const v1::Digest digest =
      wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, absl::StrCat(traverse_id, "/", sequence_number));
  return absl::StrCat("traverse-", wire::HexText(digest.value()));
}

absl::Status ForgetStreamedUpload(const std::string& traverse_id, uint64_t sequence_number, ScanStore& store) {
  const absl::StatusOr<UploadState> partial = store.GetUpload(StreamedUploadId(traverse_id, sequence_number));
  if (wire::ReasonOf(partial.status()) == v1::ERROR_REASON_UPLOAD_NOT_FOUND) return absl::OkStatus();
  if (!partial.ok()) return partial.status();
  const absl::StatusOr<std::unique_ptr<UploadWriter>> writer = store.BeginUpload(partial->description);
  return writer.ok() ? (*writer)->Discard() : writer.status();
}

}  // namespace curvereg::server
