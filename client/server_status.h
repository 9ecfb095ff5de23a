// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#ifndef CURVEREG_CLIENT_SERVER_STATUS_H_
#define CURVEREG_CLIENT_SERVER_STATUS_H_

#include "absl/status/statusor.h"
#include "client/client.h"
#include "client/connection.h"
#include "core/base/stop.h"

namespace curvereg::internal {

// See Client::Status.
absl::StatusOr<ServerStatus> FetchServerStatus(Connection& connection, const Stop& until);

// Why a connection cannot be made, as gRPC tells it; `fallback` when it does not.
absl::Status ExplainNoConnection(Connection& connection, const absl::Status& fallback);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_SERVER_STATUS_H_
