// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What is tried again, when, and how often.
#ifndef CURVEREG_CLIENT_RETRY_H_
#define CURVEREG_CLIENT_RETRY_H_

#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>

#include "absl/status/status.h"
#include "client/client.h"
#include "client/connection.h"
#include "core/base/stop.h"

namespace curvereg::internal {

// The error with its details. A delay in the trailer grpc-retry-pushback-ms becomes a RetryInfo where there is none; a
// negative one ("do not come back") takes the RetryInfo's place as the longest delay there is.
absl::Status CallError(const grpc::Status& status, const grpc::ClientContext& context);

// UNAVAILABLE; RESOURCE_EXHAUSTED that says when to come back, or of gRPC short of memory; CANCELLED without a reason
// of ours, which is a server that ended under the call. ABORTED never: another writer must not be fought.
bool IsRetryable(const absl::Status& error);

// IsRetryable, and what damage on the way looks like: a wrong checksum, an offset that does not fit, INTERNAL or
// UNKNOWN without a reason of ours. For transfers, which go on from what is known to be right.
bool IsResumable(const absl::Status& error);

// NOT_SERVING: the call was not done; another server, or this one after its restart, takes it.
bool IsRefusal(const absl::Status& error);

// Delays between attempts.
class Backoff {
 public:
  explicit Backoff(const RetryOptions& options) : options_(options), next_(options.initial_backoff) {}

  // Before the next attempt, `jitter` from [0, 1); nullopt: enough. A delay that the error asks for is the least.
  // IsRefusal does not count, for a restart may take longer than a few attempts.
  std::optional<std::chrono::milliseconds> NextDelay(const absl::Status& error, double jitter);
  void Restart();

 private:
  RetryOptions options_;
  std::chrono::milliseconds next_;
  int num_failures_ = 0;
};

// OK, or CANCELLED, or DEADLINE_EXCEEDED at once when the deadline would come first.
absl::Status SleepFor(std::chrono::milliseconds delay, const Stop& stop);

// Repeats attempts on a connection that is there. The time allowed counts from the start, and again from each progress.
class Retrier {
 public:
  struct Options {
    std::stop_token cancellation;
    std::chrono::milliseconds timeout{0};
    std::function<bool(const absl::Status&)> may_retry = IsRetryable;
    bool until_timeout = false;  // attempts are not counted, only time
  };
  Retrier(Connection& connection, const Options& options);

  // The last error when attempts or time are used up, in our words where gRPC's say little. `attempt` ends by Now()'s
  // deadline and cancellation.
  absl::Status Run(const std::function<absl::Status(const std::shared_ptr<grpc::Channel>&)>& attempt);
  // Starts counting attempts and time again. From within an attempt.
  void NoteProgress();
  Stop Now() const { return {options_.cancellation, deadline_}; }
  int num_attempts() const { return num_attempts_; }

 private:
  absl::Status InOurWords(const absl::Status& error) const;

  Connection& connection_;
  Options options_;
  Backoff backoff_;
  std::chrono::steady_clock::time_point deadline_;
  int num_attempts_ = 0;
};

// A unary call with retries and token, until `stop` or the call timeout, whichever is nearer.
using UnaryAttempt = std::function<grpc::Status(const std::shared_ptr<grpc::Channel>&, grpc::ClientContext*)>;
absl::Status CallUnary(Connection& connection, const UnaryAttempt& attempt, const Stop& stop = {});

// The same for a deletion: NOT_FOUND is OK after an attempt whose answer was lost, for that may have deleted it.
absl::Status CallDeletion(Connection& connection, const UnaryAttempt& attempt, const Stop& stop = {});

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_RETRY_H_
