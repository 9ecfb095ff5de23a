// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A download, over as many streams as it takes.
#ifndef CURVEREG_CLIENT_DOWNLOAD_H_
#define CURVEREG_CLIENT_DOWNLOAD_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/client.h"
#include "client/connection.h"
#include "core/scan/scan.h"

namespace curvereg::internal {

// See Client::DownloadScan.
absl::StatusOr<Scan> DownloadScan(Connection& connection, const std::string& name, const TransferOptions& options);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_DOWNLOAD_H_
