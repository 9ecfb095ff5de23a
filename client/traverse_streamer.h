// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A streamer: scans in, over as many streams as it takes.
#ifndef CURVEREG_CLIENT_TRAVERSE_STREAMER_H_
#define CURVEREG_CLIENT_TRAVERSE_STREAMER_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/connection.h"
#include "client/traverses.h"

namespace curvereg::internal {

// See TraverseClient::Stream. The connection outlives the streamer.
absl::StatusOr<std::unique_ptr<ScanStreamer>> StreamScans(Connection& connection, const std::string& name,
                                                          const StreamOptions& options);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_TRAVERSE_STREAMER_H_
