// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// How a channel is made from ClientOptions: checks, credentials, gRPC's channel arguments.
#ifndef CURVEREG_CLIENT_CHANNEL_SETUP_H_
#define CURVEREG_CLIENT_CHANNEL_SETUP_H_

#include <grpcpp/security/credentials.h>
#include <grpcpp/support/channel_arguments.h>

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "client/client.h"

namespace curvereg::internal {

// True when every address that the gRPC name `target` gives is on this machine: "localhost", 127.0.0.0/8, ::1, unix
// sockets. Names are not looked up.
bool IsLoopbackTarget(std::string_view target);

// INVALID_ARGUMENT naming the option: times and counts not above 0, a token that cannot be sent or would go over a
// network in plain text, TLS files without tls.enabled, a certificate without its key.
absl::Status ValidateOptions(std::string_view target, const ClientOptions& options);

// INVALID_ARGUMENT: a file that cannot be read or is empty.
absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> MakeCredentials(const TlsOptions& tls);

grpc::ChannelArguments MakeChannelArguments(std::string_view target, const ClientOptions& options);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_CHANNEL_SETUP_H_
