// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The upload that a scan of a traverse comes in: a later stream goes on with it where an earlier one was cut.
#ifndef CURVEREG_SERVER_TRAVERSES_STREAMED_UPLOAD_H_
#define CURVEREG_SERVER_TRAVERSES_STREAMED_UPLOAD_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

std::string StreamedUploadId(const std::string& traverse_id, uint64_t sequence_number);

// Forgets what came of it so far. OK also when there is none. Errors of the store.
absl::Status ForgetStreamedUpload(const std::string& traverse_id, uint64_t sequence_number, ScanStore& store);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRAVERSES_STREAMED_UPLOAD_H_
