// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the gRPC port is secured with.
#ifndef CURVEREG_SERVER_ACCESS_CREDENTIALS_H_
#define CURVEREG_SERVER_ACCESS_CREDENTIALS_H_

#include <grpcpp/security/server_credentials.h>

#include <memory>

#include "absl/status/statusor.h"
#include "server/settings/server_config.h"

namespace curvereg::server {

// Plain text when no certificate is set, else TLS 1.2 or newer. The files are read again when they change, and
// connections made from then on use them; replace a key and its certificate together (rename a folder or a link), for
// a pair that does not match refuses connections until it does. INVALID_ARGUMENT naming the setting and the file:
// cannot be read, is not PEM, or the key is not the certificate's.
absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MakeServerCredentials(const TlsConfig& config);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_ACCESS_CREDENTIALS_H_
