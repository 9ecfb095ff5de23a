// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What every call goes through: authorisation, request id, fairness key, stop token, metrics and log line. A handler
// begins with a Call and ends with its Finish.
#ifndef CURVEREG_SERVER_RPC_CALL_H_
#define CURVEREG_SERVER_RPC_CALL_H_

#include <grpcpp/server_context.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "core/base/stop.h"
#include "server/access/access.h"
#include "server/operations/logging.h"
#include "server/operations/metrics.h"

namespace curvereg::server {

// What calls share. All outlives them.
struct CallEnvironment {
  const Access* access = nullptr;
  Metrics* metrics = nullptr;
  Logger* logger = nullptr;              // null: no lines
  std::atomic<int>* num_open = nullptr;  // null: not counted
  std::stop_token draining;              // requested: new calls are refused, and idle streams end, with NOT_SERVING
  std::stop_token ending;                // requested: calls that run are stopped, and end with NOT_SERVING
};

struct MethodTraits {
  const char* service;  // "curvereg.v1.ScanService"
  const char* method;   // "GetScan"
  Scope scope;
};

// CANCELLED: there is no caller left to answer.
inline absl::Status CallerIsGone() { return absl::CancelledError("the caller cancelled or is gone"); }

class Call {
 public:
  // Admits the call or keeps the error for `admitted()`. Echoes the request id as initial metadata x-request-id: the
  // caller's, when it is 1 to 64 printable characters, else a random one.
  Call(const CallEnvironment& environment, const MethodTraits& traits, grpc::CallbackServerContext& context);

  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  const absl::Status& admitted() const { return admitted_; }  // UNAUTHENTICATED, SCOPE_MISSING, NOT_SERVING
  const std::string& client() const { return client_; }       // token name, TLS identity, else address and port
  const std::string& request_id() const { return request_id_; }

  // From OnCancel; the server's end does the same. The deadline of the call is in the Stop as well.
  void Cancel() { cancellation_.request_stop(); }
  Stop stop() const { return {cancellation_.get_token(), deadline_}; }

  void CountReceived();
  void CountSent();

  // Once, at the end: counts, logs, adds grpc-retry-pushback-ms to errors with a RetryInfo, maps the status. CANCELLED
  // past the deadline becomes DEADLINE_EXCEEDED, for then gRPC cancels, too; at the server's end NOT_SERVING.
  grpc::Status Finish(const absl::Status& end);

 private:
  // With a share of its own in the source: a task that it drops may be the last thing that the call waited for.
  struct RequestStop {
    std::stop_source source;
    void operator()() const { std::stop_source(source).request_stop(); }
  };

  absl::Status WhyEnded(const absl::Status& end) const;

  const CallEnvironment environment_;
  const MethodTraits traits_;
  grpc::CallbackServerContext& context_;
  std::chrono::steady_clock::time_point started_;
  std::optional<std::chrono::steady_clock::time_point> deadline_;
  std::stop_source cancellation_;
  std::string client_;
  std::string request_id_;
  absl::Status admitted_;
  const std::stop_callback<RequestStop> on_ending_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_RPC_CALL_H_
