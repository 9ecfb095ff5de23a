// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a method that is sent bytes in chunks does with its messages, apart from the streaming. ChunkStream runs a
// session over gRPC; tests and fuzzers run it alone.
#ifndef CURVEREG_SERVER_RPC_STREAM_SESSION_H_
#define CURVEREG_SERVER_RPC_STREAM_SESSION_H_

#include <grpcpp/support/byte_buffer.h>

#include <concepts>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "absl/status/statusor.h"

namespace curvereg::server {

// What a session has of its stream.
struct StreamHandle {
  std::stop_source replaced;   // to be requested to stop by the session that takes over: ends with WRITER_REPLACED
  std::function<void()> wake;  // there may be notifications; from any thread, until the session is destroyed
};

// Handle and TakeNotifications run on the disk pool, one at a time. The others are called between them, must be quick
// and must not block.
template <typename S>
concept StreamSession = requires(S session, const S const_session, grpc::ByteBuffer bytes, typename S::Request request,
                                 const typename S::Request const_request, const typename S::Response response,
                                 std::vector<typename S::Response> notifications,
                                 const typename S::Environment environment, StreamHandle stream) {
  S(environment, stream);
  // False: not a request.
  { S::Parse(bytes, request) } -> std::same_as<bool>;
  { S::IsChunk(const_request) } -> std::same_as<bool>;
  // Does what the request asks; the answer, if there is one. An error ends the call, after the answers to the requests
  // before.
  { session.Handle(request) } -> std::same_as<absl::StatusOr<std::optional<typename S::Response>>>;
  // After a wake: adds the next few notifications. None: there are none before the next wake.
  { session.TakeNotifications(notifications) } -> std::same_as<absl::Status>;
  // `older`, an answer that is not written yet, may be left out once there is `newer`.
  { S::Supersedes(response, response) } -> std::same_as<bool>;
  // The last answer was the last thing to do: the call ends OK, whatever else comes in.
  { const_session.is_done() } -> std::same_as<bool>;
  // The client has ended its side and all of it is handled: what the call ends with; nullopt: not yet. OK takes effect
  // when all notifications are written.
  { const_session.EndOfInput() } -> std::same_as<std::optional<absl::Status>>;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_RPC_STREAM_SESSION_H_
