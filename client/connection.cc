// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/connection.h"

#include <grpcpp/create_channel.h>

#include <algorithm>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "client/channel_setup.h"

namespace curvereg::internal {
namespace {

using Clock = std::chrono::steady_clock;

// How long a cancellation may go unnoticed while waiting for a connection.
constexpr std::chrono::milliseconds kPollInterval(50);

// gRPC's deadlines are on the system's clock.
std::chrono::system_clock::time_point FromNow(Clock::duration time) {
  return std::chrono::system_clock::now() + std::chrono::duration_cast<std::chrono::system_clock::duration>(time);
}

}  // namespace

Connection::Connection(std::string target, const ClientOptions& options)
    : target_(std::move(target)), options_(options), random_(std::random_device{}()) {}

absl::StatusOr<std::unique_ptr<Connection>> Connection::Open(const std::string& target, const ClientOptions& options) {
  if (absl::Status status = ValidateOptions(target, options); !status.ok()) return status;
  absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> credentials = MakeCredentials(options.tls);
  if (!credentials.ok()) return credentials.status();
  std::unique_ptr<Connection> connection(new Connection(target, options));
  connection->credentials_ = *std::move(credentials);
  connection->channel_ = connection->MakeChannel();
  return connection;
}

std::unique_ptr<Connection> Connection::Over(std::shared_ptr<grpc::Channel> channel, const ClientOptions& options) {
  std::unique_ptr<Connection> connection(new Connection("", options));
  connection->channel_ = std::move(channel);
  return connection;
}

std::shared_ptr<grpc::Channel> Connection::MakeChannel() const {
  return grpc::CreateCustomChannel(target_, credentials_, MakeChannelArguments(target_, options_));
}

std::shared_ptr<grpc::Channel> Connection::channel() const {
  const std::lock_guard lock(mutex_);
  return channel_;
}

void Connection::Rebuild(const std::shared_ptr<grpc::Channel>& old) {
  const std::lock_guard lock(mutex_);
  if (channel_ == old) channel_ = MakeChannel();
}

absl::Status Connection::AwaitReady(const Stop& until) {
  if (target_.empty()) return until.Cancelled() ? absl::CancelledError("cancelled by the caller") : absl::OkStatus();
  const Clock::duration patience = 2 * options_.connect_timeout;
  Clock::time_point rebuild_at = Clock::now() + patience;
  while (true) {
    const std::shared_ptr<grpc::Channel> current = channel();
    const grpc_connectivity_state state = current->GetState(/*try_to_connect=*/true);
    if (until.Cancelled()) return absl::CancelledError("cancelled by the caller");
    if (state == GRPC_CHANNEL_READY) return absl::OkStatus();
    if (until.PastDeadline()) return absl::UnavailableError(absl::StrCat("no connection to ", target_));
    if (Clock::now() >= rebuild_at || state == GRPC_CHANNEL_SHUTDOWN) {
      Rebuild(current);
      rebuild_at = Clock::now() + patience;
      continue;
    }
    Clock::duration wait = kPollInterval;
    if (until.deadline) wait = std::min<Clock::duration>(wait, *until.deadline - Clock::now());
    current->WaitForStateChange(state, FromNow(wait));
  }
}

void Connection::Prepare(grpc::ClientContext& context) const {
  if (!options_.token.empty()) context.AddMetadata("authorization", "Bearer " + options_.token);
}

double Connection::Jitter() {
  const std::lock_guard lock(mutex_);
  return std::uniform_real_distribution<double>(0.0, 1.0)(random_);
}

}  // namespace curvereg::internal
