// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A registration over the wire, each attempt with what is left of its time.
#ifndef CURVEREG_CLIENT_REGISTRATION_H_
#define CURVEREG_CLIENT_REGISTRATION_H_

#include "absl/status/statusor.h"
#include "client/client.h"
#include "client/connection.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"

namespace curvereg::internal {

// See Client::RegisterScans.
absl::StatusOr<RegistrationResult> RegisterScans(Connection& connection, const ScanReference& source,
                                                 const ScanReference& target, const RegistrationOptions& options,
                                                 const TransferEncoding& encoding);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_REGISTRATION_H_
