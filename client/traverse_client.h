// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The calls about traverses, over the connection of a client.
#ifndef CURVEREG_CLIENT_TRAVERSE_CLIENT_H_
#define CURVEREG_CLIENT_TRAVERSE_CLIENT_H_

#include <memory>

#include "client/connection.h"
#include "client/traverses.h"

namespace curvereg::internal {

// The connection outlives it.
std::unique_ptr<TraverseClient> MakeTraverseClient(Connection& connection);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_TRAVERSE_CLIENT_H_
