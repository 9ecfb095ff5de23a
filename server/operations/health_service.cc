// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/health_service.h"

#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace curvereg::server {

using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;
using ServingStatus = HealthCheckResponse::ServingStatus;

struct HealthService::State {
  std::optional<ServingStatus> StatusOf(const std::string& service) {
    const std::lock_guard lock(mutex);
    const auto found = is_serving.find(service);
    if (found == is_serving.end()) return std::nullopt;
    return found->second && !is_draining ? HealthCheckResponse::SERVING : HealthCheckResponse::NOT_SERVING;
  }

  bool HaveWatchesEnded() {
    const std::lock_guard lock(mutex);
    return have_watches_ended;
  }

  // Calls `change` under the lock, then lets all watchers look; without the lock, for they take it.
  template <typename Change>
  void ChangeAndTell(Change change);

  std::mutex mutex;
  std::map<std::string, bool> is_serving;
  bool is_draining = false;
  bool have_watches_ended = false;
  std::set<std::shared_ptr<Watcher>> watchers;
};

// One Watch stream. gRPC may call a reactor back from inside StartWrite and Finish, so neither is called under a lock;
// `is_writing_` keeps the others out meanwhile.
class HealthService::Watcher final : public grpc::ServerWriteReactor<HealthCheckResponse>,
                                     public std::enable_shared_from_this<Watcher> {
 public:
  Watcher(std::shared_ptr<State> state, std::string service) : state_(std::move(state)), service_(std::move(service)) {}

  // Does what is next: ends the stream, writes a status that has changed, or nothing.
  void Advance() {
    std::optional<grpc::Status> end;
    {
      const std::lock_guard lock(mutex_);
      if (is_writing_ || has_finished_) return;
      end = EndStatus();
      if (end.has_value()) {
        has_finished_ = true;
      } else {
        const ServingStatus status = state_->StatusOf(service_).value_or(HealthCheckResponse::SERVICE_UNKNOWN);
        if (sent_ == status) return;
        sent_ = status;
        response_.set_status(status);
        is_writing_ = true;
      }
    }
    if (end.has_value()) {
      Finish(*end);
    } else {
      StartWrite(&response_);
    }
  }

  void OnWriteDone(bool ok) override {
    {
      const std::lock_guard lock(mutex_);
      is_writing_ = false;
      is_cancelled_ = is_cancelled_ || !ok;
    }
    Advance();
  }

  void OnCancel() override {
    {
      const std::lock_guard lock(mutex_);
      is_cancelled_ = true;
    }
    Advance();
  }

  void OnDone() override {
    const std::shared_ptr<Watcher> self = shared_from_this();  // until the lock is let go
    const std::lock_guard lock(state_->mutex);
    state_->watchers.erase(self);
  }

 private:
  std::optional<grpc::Status> EndStatus() {
    if (is_cancelled_) return grpc::Status::CANCELLED;
    if (state_->HaveWatchesEnded()) return grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server is about to stop");
    return std::nullopt;
  }

  const std::shared_ptr<State> state_;
  const std::string service_;
  std::mutex mutex_;
  HealthCheckResponse response_;
  std::optional<ServingStatus> sent_;
  bool is_writing_ = false;
  bool is_cancelled_ = false;
  bool has_finished_ = false;
};

template <typename Change>
void HealthService::State::ChangeAndTell(Change change) {
  std::vector<std::shared_ptr<Watcher>> told;
  {
    const std::lock_guard lock(mutex);
    change();
    told.assign(watchers.begin(), watchers.end());
  }
  for (const std::shared_ptr<Watcher>& watcher : told) watcher->Advance();
}

HealthService::HealthService() : state_(std::make_shared<State>()) {}
HealthService::~HealthService() = default;

void HealthService::SetServing(const std::string& service, bool serving) {
  state_->ChangeAndTell([&] { state_->is_serving[service] = serving; });
}

void HealthService::Drain() {
  state_->ChangeAndTell([&] { state_->is_draining = true; });
}

void HealthService::EndWatches() {
  state_->ChangeAndTell([&] { state_->have_watches_ended = true; });
}

grpc::ServerUnaryReactor* HealthService::Check(grpc::CallbackServerContext* context, const HealthCheckRequest* request,
                                               HealthCheckResponse* response) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const std::optional<ServingStatus> status = state_->StatusOf(request->service());
  if (status.has_value()) response->set_status(*status);
  reactor->Finish(status.has_value() ? grpc::Status::OK
                                     : grpc::Status(grpc::StatusCode::NOT_FOUND, "no service of that name"));
  return reactor;
}

grpc::ServerWriteReactor<HealthCheckResponse>* HealthService::Watch(grpc::CallbackServerContext* /*context*/,
                                                                    const HealthCheckRequest* request) {
  auto watcher = std::make_shared<Watcher>(state_, request->service());
  {
    const std::lock_guard lock(state_->mutex);
    state_->watchers.insert(watcher);
  }
  watcher->Advance();
  return watcher.get();  // state_ holds it until OnDone
}

}  // namespace curvereg::server
