// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/call.h"

#include <sys/random.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "wire/error.h"
#include "wire/status_mapping.h"

namespace curvereg::server {
namespace {

constexpr char kRequestIdKey[] = "x-request-id";
constexpr char kPushbackKey[] = "grpc-retry-pushback-ms";
constexpr std::size_t kMaxRequestIdBytes = 64;

std::string MetadataValue(const grpc::CallbackServerContext& context, const char* key) {
  const auto found = context.client_metadata().find(key);
  return found == context.client_metadata().end() ? std::string()
                                                  : std::string(found->second.data(), found->second.size());
}

bool IsUsableRequestId(std::string_view id) {
  return !id.empty() && id.size() <= kMaxRequestIdBytes &&
         std::all_of(id.begin(), id.end(), [](char c) { return c > ' ' && c <= '~'; });
}

std::string RequestIdOf(const grpc::CallbackServerContext& context) {
  std::string id = MetadataValue(context, kRequestIdKey);
  if (IsUsableRequestId(id)) return id;
  // A std::random_device made for each call asks the processor what it is, which is slow on virtual machines.
  uint64_t bits = 0;
  static_cast<void>(getrandom(&bits, sizeof(bits), 0));  // never short at this size
  return absl::StrFormat("%016x", bits);
}

// A connection is one client unless it says, in a way that was checked, who it is.
std::string ClientOf(const grpc::CallbackServerContext& context, const std::string& token_name) {
  if (!token_name.empty()) return absl::StrCat("token:", token_name);
  const auto auth = context.auth_context();
  if (auth != nullptr && auth->IsPeerAuthenticated()) {
    for (const grpc::string_ref& identity : auth->GetPeerIdentity()) {
      return absl::StrCat("tls:", std::string(identity.data(), identity.size()));
    }
  }
  return context.peer();
}

// The wall clock may be set while a call runs; what computes asks the steady one.
std::optional<std::chrono::steady_clock::time_point> DeadlineOf(const grpc::CallbackServerContext& context) {
  const auto deadline = context.deadline();
  const auto now = std::chrono::system_clock::now();
  if (deadline - now > std::chrono::hours(24 * 365)) return std::nullopt;
  return std::chrono::steady_clock::now() + (deadline - now);
}

}  // namespace

Call::Call(const CallEnvironment& environment, const MethodTraits& traits, grpc::CallbackServerContext& context)
    : environment_(environment),
      traits_(traits),
      context_(context),
      started_(std::chrono::steady_clock::now()),
      deadline_(DeadlineOf(context)),
      request_id_(RequestIdOf(context)),
      on_ending_(environment.ending, RequestStop{cancellation_}) {
  if (environment_.num_open != nullptr) ++*environment_.num_open;
  context_.AddInitialMetadata(kRequestIdKey, request_id_);
  environment_.metrics->RpcStarted(traits_.service, traits_.method);
  const absl::StatusOr<std::string> name =
      environment_.access->Check(MetadataValue(context, "authorization"), traits_.scope);
  client_ = ClientOf(context, name.ok() ? *name : std::string());
  if (!name.ok()) {
    admitted_ = name.status();
  } else if (environment_.draining.stop_requested()) {
    admitted_ = wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "the server is about to stop");
  }
}

Call::~Call() {
  if (environment_.num_open != nullptr) --*environment_.num_open;
}

void Call::CountReceived() { environment_.metrics->MessageReceived(traits_.service, traits_.method); }

void Call::CountSent() { environment_.metrics->MessageSent(traits_.service, traits_.method); }

absl::Status Call::WhyEnded(const absl::Status& end) const {
  if (!absl::IsCancelled(end)) return end;
  if (stop().PastDeadline()) {
    return wire::MakeError(v1::ERROR_REASON_DEADLINE_EXCEEDED, "the deadline of the call passed");
  }
  if (environment_.ending.stop_requested()) {
    return wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "the server stopped before the call was done");
  }
  return end;
}

grpc::Status Call::Finish(const absl::Status& end) {
  const absl::Status status = WhyEnded(end);
  const grpc::Status mapped = wire::ToGrpcStatus(status, request_id_);
  const auto duration = std::chrono::steady_clock::now() - started_;
  const std::string code = absl::StatusCodeToString(static_cast<absl::StatusCode>(mapped.error_code()));
  const std::optional<google::rpc::ErrorInfo> info = wire::ErrorInfoOf(wire::FromGrpcStatus(mapped));
  environment_.metrics->RpcHandled(traits_.service, traits_.method, code, duration);
  if (const auto delay = wire::RetryDelayOf(status); delay.has_value()) {
    context_.AddTrailingMetadata(kPushbackKey, absl::StrCat(delay->count()));
  }
  if (mapped.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED) environment_.metrics->Rejected(info->reason());
  if (environment_.logger != nullptr) {
    environment_.logger->Call({.service = traits_.service,
                               .method = traits_.method,
                               .request_id = request_id_,
                               .client = client_,
                               .code = code,
                               .reason = info.has_value() ? info->reason() : std::string(),
                               .message = std::string(status.message()),
                               .milliseconds = std::chrono::duration<double, std::milli>(duration).count()});
  }
  return mapped;
}

}  // namespace curvereg::server
