// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// An upload from the first byte to the stored scan, over as many streams as it takes.
#ifndef CURVEREG_CLIENT_UPLOAD_H_
#define CURVEREG_CLIENT_UPLOAD_H_

#include "absl/status/statusor.h"
#include "client/client.h"
#include "client/connection.h"
#include "core/scan/scan.h"

namespace curvereg::internal {

// See Client::UploadScan.
absl::StatusOr<UploadOutcome> UploadScan(Connection& connection, const curvereg::Scan& scan,
                                         const TransferOptions& options);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_UPLOAD_H_
