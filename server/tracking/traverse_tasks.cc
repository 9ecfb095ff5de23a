// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// TraverseEngine's work on the pool.
#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/parallel.h"
#include "server/rpc/caught.h"
#include "server/tracking/traverse_conversion.h"
#include "server/tracking/traverse_engine.h"
#include "wire/duration.h"
#include "wire/error.h"
#include "wire/timestamp.h"

namespace curvereg::server {
namespace {

constexpr std::chrono::milliseconds kFirstRetry{50};
constexpr std::chrono::milliseconds kLastRetry{10'000};
constexpr std::chrono::minutes kMemory{1};  // of what can be read again, while nothing is to be done
constexpr std::size_t kMaxRequests = 16;    // that wait for their turn
constexpr int kMaxFailures = 8;             // of one piece of work, then it is given up
constexpr int kMaxPreempted = 3;            // of what gives way to new scans, then it does not

absl::Status TooManyRequests() {
  return wire::WithRetryDelay(
      wire::MakeError(v1::ERROR_REASON_QUEUE_FULL, "too many optimisations of the traverse wait already"),
      std::chrono::seconds(1));
}

absl::Status Ended() { return wire::MakeError(v1::ERROR_REASON_CANCELLED, "the traverse was closed or deleted"); }

}  // namespace

// Stops when the caller does and when the traverse is closed.
struct TraverseEngine::Request {
  Request(const v1::OptimizeTraverseRequest& asked_for, std::string of_client, const Stop& of_caller,
          Traverses::OptimizeDone when_done)
      : request(asked_for), client(std::move(of_client)), done(std::move(when_done)), stop(of_caller) {
    stop.cancellation = ending.get_token();
  }
  void StopWith(const std::stop_token& caller, const std::stop_token& closing) {
    on_cancel.emplace(caller, [this] { ending.request_stop(); });
    on_close.emplace(closing, [this] { ending.request_stop(); });
  }

  const v1::OptimizeTraverseRequest request;
  const std::string client;
  const Traverses::OptimizeDone done;
  std::stop_source ending;
  Stop stop;
  std::optional<std::stop_callback<std::function<void()>>> on_cancel;
  std::optional<std::stop_callback<std::function<void()>>> on_close;
};

void TraverseEngine::Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client, const Stop& stop,
                              Traverses::OptimizeDone done) {
  const auto waiting = std::make_shared<Request>(request, client, stop, std::move(done));
  waiting->StopWith(stop.cancellation, closing_.get_token());
  {
    std::unique_lock lock(mutex_);
    if (closed_ || requests_.size() >= kMaxRequests) {
      const absl::Status refusal = closed_ ? Ended() : TooManyRequests();
      lock.unlock();
      waiting->done(refusal);
      return;
    }
    requests_.push_back(waiting);
  }
  Kick();
}

TraverseEngine::Kind TraverseEngine::NextKind() const {
  if (closed_ || working_) return Kind::kNone;
  if (!requests_.empty()) return Kind::kOptimize;
  if (is_waiting_) return Kind::kNone;
  const v1::Traverse& traverse = record_.traverse;
  if (traverse.registered_scan_count() < traverse.next_sequence_number()) return Kind::kTrack;
  if (record_.num_linked_scans < traverse.registered_scan_count()) return Kind::kLookAround;
  return revision_due_ ? Kind::kRevise : Kind::kNone;
}

void TraverseEngine::Kick() {
  Kind kind = Kind::kNone;
  std::shared_ptr<Request> request;
  {
    const std::lock_guard lock(mutex_);
    kind = NextKind();
    if (kind == Kind::kNone) return;
    working_ = true;
    background_ = std::stop_source();
    if (kind == Kind::kOptimize) {
      request = std::move(requests_.front());
      requests_.pop_front();
    }
  }
  Submit(kind, std::move(request));
}

void TraverseEngine::Submit(Kind kind, std::shared_ptr<Request> request) {
  const auto self = shared_from_this();
  const absl::Status accepted = environment_.pool->Submit(
      {.client = request == nullptr ? client_ : request->client,
       .cancellation = request == nullptr ? closing_.get_token() : request->stop.cancellation,
       .run =
           [self, kind, request](std::chrono::nanoseconds waited) {
             self->environment_.work.scans.calls.metrics->QueueWaited(waited);
             self->Run(kind, request);
           },
       .drop = [self, request](const absl::Status& reason) { self->OnRefused(reason, request); }});
  if (!accepted.ok()) OnRefused(accepted, request);
}

void TraverseEngine::OnRefused(const absl::Status& status, const std::shared_ptr<Request>& request) {
  if (request != nullptr) request->done(status);
  EndTask(request == nullptr ? status : absl::OkStatus(), true, Kind::kNone);
}

void TraverseEngine::Run(Kind kind, const std::shared_ptr<Request>& request) {
  if (request == nullptr) {
    const absl::Status status = Caught([&] { return Do(kind); });
    if (absl::IsInternal(status)) work_.Forget();  // it may have been left half done
    EndTask(status, false, kind);
    return;
  }
  absl::StatusOr<v1::OptimizeTraverseResponse> response = Ended();
  const absl::Status status = Caught([&] {
    WithThreadLimit(num_threads_, [&] { response = OptimizeNow(*request); });
    return response.status();
  });
  if (!status.ok()) response = status;
  if (absl::IsInternal(status)) work_.Forget();
  request->done(std::move(response));
  EndTask(absl::OkStatus(), false, Kind::kOptimize);
}

void TraverseEngine::EndTask(const absl::Status& status, bool is_refused, Kind kind) {
  {
    const std::lock_guard lock(mutex_);
    working_ = false;
    idle_.notify_all();
    if (closed_) return;  // from here on nothing of the environment may be there
    // What gave way to a scan is no failure.
    const bool is_preempted = absl::IsCancelled(status);
    // Each kind for itself: what the other gets done between two attempts is no progress of this one.
    if (kind == Kind::kLookAround || kind == Kind::kRevise) {
      int& num_preempted = num_preempted_[kind == Kind::kRevise];
      num_preempted = is_preempted ? num_preempted + 1 : 0;
    }
    const bool is_failure = !status.ok() && !is_preempted;
    if (!is_refused) num_failures_ = is_failure ? num_failures_ + 1 : 0;
    if (is_failure) Wait(status);
    last_work_ = std::chrono::steady_clock::now();
    if (NextKind() == Kind::kNone) ForgetLater();
  }
  Kick();
}

void TraverseEngine::Wait(const absl::Status& status) {
  const std::chrono::milliseconds delay =
      wire::RetryDelayOf(status).value_or(kFirstRetry * (1 << std::min(num_failures_, kMaxFailures)));
  is_waiting_ = true;
  environment_.work.logger->Debug("traverse_waits", {{"traverse", name_}, {"message", std::string(status.message())}});
  environment_.delayed->After(std::min(delay, kLastRetry), [weak = weak_from_this()] {
    const auto self = weak.lock();
    if (self == nullptr) return;
    {
      const std::lock_guard lock(self->mutex_);
      self->is_waiting_ = false;
    }
    self->Kick();
  });
}

void TraverseEngine::ForgetLater() {
  if (std::exchange(is_to_forget_, true)) return;
  environment_.delayed->After(kMemory, [weak = weak_from_this()] {
    const auto self = weak.lock();
    if (self == nullptr) return;
    const std::lock_guard lock(self->mutex_);
    self->is_to_forget_ = false;
    if (self->closed_ || self->working_) return;
    if (std::chrono::steady_clock::now() - self->last_work_ >= kMemory) {
      self->work_.Forget();
    } else {
      self->ForgetLater();
    }
  });
}

absl::StatusOr<MemoryBudget::Reservation> TraverseEngine::ReserveForRegistration() const {
  return environment_.work.scans.memory->Reserve(2 * PreparationBytes(0));
}

absl::Status TraverseEngine::Do(Kind kind) {
  const absl::StatusOr<MemoryBudget::Reservation> reservation = ReserveForRegistration();
  if (!reservation.ok()) return reservation.status();
  absl::Status status = work_.Load(record());
  if (!status.ok()) return status;
  WithThreadLimit(num_threads_, [&] { status = kind == Kind::kTrack ? Track() : InBackground(kind); });
  return status;
}

absl::Status TraverseEngine::Track() {
  const TraverseRecord before = record();
  const absl::StatusOr<std::optional<AcknowledgedScan>> scan =
      environment_.work.store->FindScan(before.number, before.traverse.registered_scan_count());
  if (!scan.ok()) return scan.status();
  if (!scan->has_value()) return absl::InternalError("an acknowledged scan is not in the database");
  bool must_end = false;
  {
    const std::lock_guard lock(mutex_);
    must_end = num_failures_ >= kMaxFailures;
  }
  absl::StatusOr<TraverseStep> step = work_.Track(**scan, must_end, {closing_.get_token(), {}});
  if (!step.ok()) return step.status();
  const absl::Status kept = Keep(*step);
  if (kept.ok()) Tell(*step);
  return kept;
}

absl::Status TraverseEngine::InBackground(Kind kind) {
  std::stop_source stop;
  bool must_end = false;
  std::stop_token preemption;
  {
    const std::lock_guard lock(mutex_);
    must_end = num_failures_ >= kMaxFailures;
    if (num_preempted_[kind == Kind::kRevise] < kMaxPreempted) preemption = background_.get_token();
  }
  const std::stop_callback on_close(closing_.get_token(), [&] { stop.request_stop(); });
  const std::stop_callback on_scan(preemption, [&] { stop.request_stop(); });
  const Stop either{stop.get_token(), {}};
  if (kind == Kind::kRevise) {
    const absl::Status revised = Revise(either).status();
    if (!must_end && !IsLasting(revised)) return revised;
    environment_.work.logger->Warning("revision_failed",
                                      {{"traverse", name_}, {"message", std::string(revised.message())}});
    const std::lock_guard lock(mutex_);
    revision_due_ = false;
    return absl::OkStatus();
  }
  absl::StatusOr<TraverseStep> step = work_.LookAround(must_end, either);
  return step.ok() ? Keep(*std::move(step)) : step.status();
}

absl::StatusOr<uint32_t> TraverseEngine::CloseLoops(const Stop& stop) {
  absl::StatusOr<TraverseStep> step = work_.CloseLoops(stop);
  if (!step.ok()) return step.status();
  const auto num_accepted = std::count_if(step->links.begin(), step->links.end(),
                                          [](const StoredLink& link) { return link.result.verdict().accepted(); });
  const absl::Status kept = Keep(*std::move(step));
  if (!kept.ok()) return kept;
  return static_cast<uint32_t>(num_accepted);
}

absl::StatusOr<TraverseRevision> TraverseEngine::Revise(const Stop& stop) {
  const auto start = std::chrono::steady_clock::now();
  absl::StatusOr<TraverseWork::Revised> revised = work_.Revise(stop);
  if (!revised.ok()) return revised.status();
  environment_.work.scans.calls.metrics->TraverseOptimized(std::chrono::steady_clock::now() - start);
  const absl::Status kept = Keep(std::move(revised->step));
  if (!kept.ok()) return kept;
  for (const SegmentJoin& join : revised->revision.joins) {
    environment_.work.scans.calls.metrics->SegmentJoined();
    environment_.work.logger->Info("segments_joined", {{"traverse", name_},
                                                       {"segment", static_cast<int64_t>(join.segment)},
                                                       {"joined_segment", static_cast<int64_t>(join.joined_segment)}});
  }
  return std::move(revised->revision);
}

absl::Status TraverseEngine::LookAroundToTheEnd(const Stop& stop) {
  for (TraverseRecord now = record(); now.num_linked_scans < now.traverse.registered_scan_count(); now = record()) {
    absl::StatusOr<TraverseStep> step = work_.LookAround(false, stop);
    if (stop.Requested()) return absl::CancelledError("cancelled while looking for links");
    if (!step.ok()) break;  // to be tried again in the background
    if (const absl::Status kept = Keep(*std::move(step)); !kept.ok()) return kept;
  }
  return absl::OkStatus();
}

absl::StatusOr<v1::OptimizeTraverseResponse> TraverseEngine::OptimizeNow(const Request& request) {
  if (request.stop.Requested()) return absl::CancelledError("cancelled while waiting");
  const absl::StatusOr<MemoryBudget::Reservation> reservation = ReserveForRegistration();
  if (!reservation.ok()) return reservation.status();
  if (absl::Status status = work_.Load(record()); !status.ok()) return status;
  if (absl::Status status = LookAroundToTheEnd(request.stop); !status.ok()) return status;
  v1::OptimizeTraverseResponse response;
  if (request.request.find_loop_closures()) {
    const absl::StatusOr<uint32_t> num_closures = CloseLoops(request.stop);
    if (!num_closures.ok()) return num_closures.status();
    response.set_loop_closure_count(*num_closures);
  }
  const absl::StatusOr<TraverseRevision> revision = Revise(request.stop);
  if (!revision.ok()) return revision.status();
  response.set_version(record().traverse.trajectory_version());
  response.set_link_count(static_cast<uint32_t>(revision->num_links));
  response.set_rejected_link_count(static_cast<uint32_t>(revision->num_rejected_links));
  response.set_max_translation_change_m(revision->max_translation_change_m);
  response.set_unconverged(!revision->converged);
  return response;
}

absl::Status TraverseEngine::Keep(TraverseStep step) {
  const google::protobuf::Timestamp now = wire::TimestampOf(std::chrono::system_clock::now());
  {
    const std::lock_guard lock(mutex_);
    TraverseRecord record = record_;
    work_.Describe(record);
    for (v1::WatchTraverseResponse& event : step.events) {
      event.set_event(record.num_events++);
      *event.mutable_time() = now;
    }
    const absl::Status kept = closed_ ? Ended() : environment_.work.store->AddStep(record, step);
    if (!kept.ok()) {
      work_.Forget();  // it is a step ahead of the database
      return kept;
    }
    record_ = std::move(record);
    revision_due_ = work_.IsRevisionDue();
  }
  environment_.work.scans.calls.metrics->TraverseEvents(step.events.size());
  if (!step.events.empty()) watchers_->Wake();
  return absl::OkStatus();
}

void TraverseEngine::Tell(const TraverseStep& step) const {
  const v1::ScanResult& result = step.events.front().result();
  const double latency_s = wire::SecondsOf(result.latency()).value_or(0.0);
  environment_.work.scans.calls.metrics->ScanTracked(result.pose().origin(), latency_s, work_.LastAcquisitionSeconds());
  Logger& logger = *environment_.work.logger;
  LogFields fields = {{"traverse", name_},
                      {"sequence_number", static_cast<int64_t>(result.sequence_number())},
                      {"segment", static_cast<int64_t>(result.pose().segment())}};
  if (result.pose().origin() == v1::POSE_ORIGIN_SEGMENT_START && result.sequence_number() > 0) {
    logger.Warning("segment_begun", fields);
  } else if (result.pose().origin() == v1::POSE_ORIGIN_PRIOR) {
    logger.Warning("pose_by_prior", fields);
  }
  fields.push_back({"ms", 1e3 * latency_s});
  logger.Debug("scan_tracked", fields);
}

void TraverseEngine::Close() {
  std::deque<std::shared_ptr<Request>> requests;
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    requests = std::exchange(requests_, {});
  }
  std::stop_source(closing_).request_stop();
  for (const std::shared_ptr<Request>& request : requests) request->done(Ended());
  std::unique_lock lock(mutex_);
  idle_.wait(lock, [&] { return !working_; });
}

void TraverseEngine::EndStream() {
  std::stop_source owner(std::nostopstate);
  {
    const std::lock_guard lock(mutex_);
    owner = std::exchange(owner_, std::stop_source(std::nostopstate));
  }
  owner.request_stop();
}

}  // namespace curvereg::server
