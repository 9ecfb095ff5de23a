// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_scheduler.h"

#include <algorithm>
#include <deque>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/scheduling/caught.h"
#include "server/tracking/traverse_conversion.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr std::chrono::milliseconds kFirstRetry{50};
constexpr std::chrono::milliseconds kLastRetry{10'000};
constexpr std::chrono::minutes kMemory{1};  // of what can be read again, while nothing is to be done
constexpr int kMaxFailures = 8;             // of one piece of work, then it is given up
constexpr int kMaxPreempted = 3;            // of what gives way to new scans, then it does not

}  // namespace

TraverseScheduler::TraverseScheduler(const TrackingEnvironment& environment, std::shared_ptr<TraverseJournal> journal,
                                     std::unique_ptr<TraverseTasks> tasks)
    : environment_(environment),
      name_(journal->record().traverse.name()),
      client_(absl::StrCat("traverse/", name_)),
      journal_(std::move(journal)),
      tasks_(std::move(tasks)) {}

void TraverseScheduler::Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client,
                                 const Stop& stop, OptimizeDone done) {
  const auto waiting = std::make_shared<OptimizationRequest>(request, client, stop, std::move(done));
  waiting->StopWith(stop.cancellation, closing_.get_token());
  absl::Status refusal = TraverseClosed();
  {
    const std::lock_guard lock(mutex_);
    if (!is_closed_) refusal = requests_.Add(waiting);
  }
  if (refusal.ok()) {
    Schedule();
  } else {
    waiting->Finish(refusal);
  }
}

void TraverseScheduler::ScanAdded() {
  std::stop_source preemption(std::nostopstate);
  {
    const std::lock_guard lock(mutex_);
    is_waiting_ = false;
    preemption = preemption_;
  }
  preemption.request_stop();
  Schedule();
}

TraverseScheduler::Kind TraverseScheduler::NextKind() const {
  if (is_closed_ || is_working_) return Kind::kNone;
  if (!requests_.empty()) return Kind::kOptimize;
  if (is_waiting_) return Kind::kNone;
  const TraverseRecord record = journal_->record();
  const v1::Traverse& traverse = record.traverse;
  if (traverse.registered_scan_count() < traverse.next_sequence_number()) return Kind::kTrack;
  if (record.num_linked_scans < traverse.registered_scan_count()) return Kind::kLookAround;
  return tasks_->is_revision_due() ? Kind::kRevise : Kind::kNone;
}

void TraverseScheduler::Schedule() {
  Kind kind = Kind::kNone;
  RequestPointer request;
  {
    const std::lock_guard lock(mutex_);
    kind = NextKind();
    if (kind == Kind::kNone) return;
    is_working_ = true;
    preemption_ = std::stop_source();
    if (kind == Kind::kOptimize) request = requests_.TakeNext();
  }
  Submit(kind, request);
}

void TraverseScheduler::Submit(Kind kind, const RequestPointer& request) {
  const auto self = shared_from_this();
  const absl::Status accepted = environment_.pool->Submit(
      {.client = request == nullptr ? client_ : request->client(),
       .cancellation = request == nullptr ? closing_.get_token() : request->stop().cancellation,
       .run =
           [self, kind, request](std::chrono::nanoseconds waited) {
             self->environment_.scans.metrics->QueueWaited(waited);
             if (request == nullptr) {
               self->RunTask(kind);
             } else {
               self->RunOptimization(*request);
             }
           },
       .drop = [self, request](const absl::Status& reason) { self->Refuse(reason, request); }});
  if (!accepted.ok()) Refuse(accepted, request);
}

void TraverseScheduler::Refuse(const absl::Status& status, const RequestPointer& request) {
  if (request != nullptr) request->Finish(status);
  EndTask(request == nullptr ? status : absl::OkStatus(), true, Kind::kNone);
}

void TraverseScheduler::RunTask(Kind kind) {
  const absl::Status status = Caught([&] { return Run(kind); });
  if (absl::IsInternal(status)) tasks_->Forget();  // it may have been left half done
  EndTask(status, false, kind);
}

void TraverseScheduler::RunOptimization(const OptimizationRequest& request) {
  absl::StatusOr<v1::OptimizeTraverseResponse> response = TraverseClosed();
  const absl::Status status = Caught([&] {
    response = tasks_->Optimize(request.request(), request.stop());
    return response.status();
  });
  if (!status.ok()) response = status;
  if (absl::IsInternal(status)) tasks_->Forget();
  request.Finish(std::move(response));
  EndTask(absl::OkStatus(), false, Kind::kOptimize);
}

absl::Status TraverseScheduler::Run(Kind kind) {
  bool must_end = false;
  std::stop_token preemption;
  {
    const std::lock_guard lock(mutex_);
    must_end = num_failures_ >= kMaxFailures;
    if (num_preempted_[kind == Kind::kRevise] < kMaxPreempted) preemption = preemption_.get_token();
  }
  if (kind == Kind::kTrack) return tasks_->Track(must_end, {closing_.get_token(), {}});
  std::stop_source either;
  const std::stop_callback on_close(closing_.get_token(), [&] { either.request_stop(); });
  const std::stop_callback on_scan(preemption, [&] { either.request_stop(); });
  const Stop stop{either.get_token(), {}};
  return kind == Kind::kRevise ? tasks_->Revise(must_end, stop) : tasks_->LookAround(must_end, stop);
}

void TraverseScheduler::EndTask(const absl::Status& status, bool is_refused, Kind kind) {
  {
    const std::lock_guard lock(mutex_);
    is_working_ = false;
    idle_.notify_all();
    if (is_closed_) return;  // from here on nothing of the environment may be there
    if (!is_refused) CountAttempt(kind, status);
    if (!status.ok() && !absl::IsCancelled(status)) RetryLater(status);
    last_work_ = std::chrono::steady_clock::now();
    if (NextKind() == Kind::kNone) ForgetLater();
  }
  Schedule();
}

void TraverseScheduler::CountAttempt(Kind kind, const absl::Status& status) {
  const bool is_preempted = absl::IsCancelled(status);  // which is no failure
  // Each kind for itself: what the other gets done between two attempts is no progress of this one.
  if (kind == Kind::kLookAround || kind == Kind::kRevise) {
    int& num_preempted = num_preempted_[kind == Kind::kRevise];
    num_preempted = is_preempted ? num_preempted + 1 : 0;
  }
  num_failures_ = status.ok() || is_preempted ? 0 : num_failures_ + 1;
}

void TraverseScheduler::RetryLater(const absl::Status& status) {
  const std::chrono::milliseconds delay =
      wire::RetryDelayOf(status).value_or(kFirstRetry * (1 << std::min(num_failures_, kMaxFailures)));
  is_waiting_ = true;
  environment_.logger->Debug("traverse_waits", {{"traverse", name_}, {"message", std::string(status.message())}});
  environment_.delayed->After(std::min(delay, kLastRetry), [weak = weak_from_this()] {
    const auto self = weak.lock();
    if (self == nullptr) return;
    {
      const std::lock_guard lock(self->mutex_);
      self->is_waiting_ = false;
    }
    self->Schedule();
  });
}

void TraverseScheduler::ForgetLater() {
  if (std::exchange(is_to_forget_, true)) return;
  environment_.delayed->After(kMemory, [weak = weak_from_this()] {
    const auto self = weak.lock();
    if (self == nullptr) return;
    const std::lock_guard lock(self->mutex_);
    self->is_to_forget_ = false;
    if (self->is_closed_ || self->is_working_) return;
    if (std::chrono::steady_clock::now() - self->last_work_ >= kMemory) {
      self->tasks_->Forget();
    } else {
      self->ForgetLater();
    }
  });
}

void TraverseScheduler::Close() {
  std::deque<RequestPointer> requests;
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
    requests = requests_.TakeAll();
  }
  std::stop_source(closing_).request_stop();
  for (const RequestPointer& request : requests) request->Finish(TraverseClosed());
  std::unique_lock lock(mutex_);
  idle_.wait(lock, [&] { return !is_working_; });
}

}  // namespace curvereg::server
