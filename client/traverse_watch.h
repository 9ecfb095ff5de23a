// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The events of a traverse, over as many streams as it takes.
#ifndef CURVEREG_CLIENT_TRAVERSE_WATCH_H_
#define CURVEREG_CLIENT_TRAVERSE_WATCH_H_

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "client/connection.h"
#include "client/traverses.h"

namespace curvereg::internal {

// See TraverseClient::Watch.
absl::Status WatchTraverse(Connection& connection, const std::string& name, const WatchOptions& options,
                           const std::function<void(const TraverseEvent&)>& on_event);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_TRAVERSE_WATCH_H_
