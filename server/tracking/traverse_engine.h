// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One traverse at work: what streams ask of it, and what is computed for it, step by step, on the worker pool. It has
// at most one task there at a time, so that traverses get their turns one after the other.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_ENGINE_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_ENGINE_H_

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "server/scheduling/delayed_calls.h"
#include "server/tracking/traverse_store.h"
#include "server/tracking/traverse_watchers.h"
#include "server/tracking/traverse_work.h"
#include "server/traverses/traverses.h"

namespace curvereg::server {

class TraverseEngine : public std::enable_shared_from_this<TraverseEngine> {
 public:
  // What engines share. All outlive them.
  struct Environment {
    TraverseWork::Environment work;
    LimitsConfig limits;
    WorkerPool* pool = nullptr;
    DelayedCalls* delayed = nullptr;
  };
  // As far as the database has it; `early`: sequence numbers acknowledged beyond the next one.
  TraverseEngine(const Environment& environment, const TraverseRecord& record, std::set<uint64_t> early,
                 const TrackingOptions& options, std::shared_ptr<TraverseWatchers> watchers);

  // Has the next piece of work done, if there is any and none is under way.
  void Kick();
  // Cancels what runs and waits for it; nothing can be done after it.
  void Close();
  // Ends the stream under way, if any, with WRITER_REPLACED.
  void EndStream();

  TraverseRecord record() const;
  const std::shared_ptr<TraverseWatchers>& watchers() const { return watchers_; }

  // As those of Traverses.
  absl::StatusOr<StreamTicket> BeginStream(const std::stop_source& owner);
  absl::Status CheckScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known);
  absl::StatusOr<uint64_t> AddScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                   const std::string& scan_id);
  void Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client, const Stop& stop,
                Traverses::OptimizeDone done);

 private:
  struct Request;  // of an optimisation
  enum class Kind { kNone, kOptimize, kTrack, kLookAround, kRevise };

  // With the mutex held.
  Kind NextKind() const;
  absl::Status Check(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) const;
  void CountAcknowledged(uint64_t sequence_number, TraverseRecord& record, std::set<uint64_t>& early) const;

  // A task, with `working_` set.
  void Submit(Kind kind, std::shared_ptr<Request> request);
  void Run(Kind kind, const std::shared_ptr<Request>& request);
  void OnRefused(const absl::Status& status, const std::shared_ptr<Request>& request);
  void EndTask(const absl::Status& status, bool is_refused, Kind kind);
  void Wait(const absl::Status& status);  // with the mutex held
  void ForgetLater();                     // with the mutex held
  absl::StatusOr<MemoryBudget::Reservation> ReserveForRegistration() const;
  absl::Status Do(Kind kind);
  absl::Status Track();
  absl::Status InBackground(Kind kind);
  absl::StatusOr<v1::OptimizeTraverseResponse> OptimizeNow(const Request& request);
  // Links that were still to be looked for: an optimisation without them would not be the best.
  absl::Status LookAroundToTheEnd(const Stop& stop);
  absl::StatusOr<uint32_t> CloseLoops(const Stop& stop);
  absl::StatusOr<TraverseRevision> Revise(const Stop& stop);
  absl::Status Keep(TraverseStep step);
  void Tell(const TraverseStep& step) const;

  const Environment& environment_;
  const std::string client_;  // whose turns the work takes
  const std::string name_;
  const int num_threads_;
  const std::shared_ptr<TraverseWatchers> watchers_;
  const std::stop_source closing_;

  mutable std::mutex mutex_;  // held while the database is changed
  std::condition_variable idle_;
  TraverseRecord record_;
  std::set<uint64_t> early_;
  std::deque<std::shared_ptr<Request>> requests_;
  std::stop_source owner_{std::nostopstate};
  std::stop_source background_;  // of what gives way to a new scan
  bool working_ = false;         // a task is out, or is about to be; work_ is its own
  bool is_waiting_ = false;      // until a refused or failed task is tried again
  bool closed_ = false;
  bool is_to_forget_ = false;  // a call that looks whether to forget what was read is waiting
  std::chrono::steady_clock::time_point last_work_;
  bool revision_due_ = false;
  int num_failures_ = 0;                // in a row
  std::array<int, 2> num_preempted_{};  // in a row, of looks around and of revisions
  TraverseWork work_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_ENGINE_H_
