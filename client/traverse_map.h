// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A map, over as many streams as it takes.
#ifndef CURVEREG_CLIENT_TRAVERSE_MAP_H_
#define CURVEREG_CLIENT_TRAVERSE_MAP_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/connection.h"
#include "client/traverses.h"

namespace curvereg::internal {

// See TraverseClient::DownloadMap.
absl::StatusOr<RemoteMap> DownloadMap(Connection& connection, const std::string& name, const MapOptions& options);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_TRAVERSE_MAP_H_
