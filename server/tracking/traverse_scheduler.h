// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// When the pieces of work on one traverse are done: optimisations that are asked for, then new scans, then what can
// wait. It has at most one task in the worker pool at a time, so that traverses get their turns one after the other.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_SCHEDULER_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_SCHEDULER_H_

#include <array>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "core/base/stop.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/tracking/optimization_requests.h"
#include "server/tracking/tracking_environment.h"
#include "server/tracking/traverse_journal.h"
#include "server/tracking/traverse_tasks.h"

namespace curvereg::server {

// Safe to use from several threads. A task in the pool shares it.
class TraverseScheduler : public std::enable_shared_from_this<TraverseScheduler> {
 public:
  // `environment` outlives it until Close.
  TraverseScheduler(const TrackingEnvironment& environment, std::shared_ptr<TraverseJournal> journal,
                    std::unique_ptr<TraverseTasks> tasks);

  // Has the next piece of work done, if there is any and none is under way.
  void Schedule();
  // A scan was acknowledged: what can wait gives way to it.
  void ScanAdded();
  // As that of TrackedTraverse.
  void Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client, const Stop& stop,
                OptimizeDone done);
  // Cancels what runs and waits for it; nothing is done after it.
  void Close();

 private:
  enum class Kind { kNone, kOptimize, kTrack, kLookAround, kRevise };
  using RequestPointer = std::shared_ptr<OptimizationRequest>;

  // With the mutex held.
  Kind NextKind() const;
  void CountAttempt(Kind kind, const absl::Status& status);
  void RetryLater(const absl::Status& status);
  void ForgetLater();

  // A task, with `is_working_` set.
  void Submit(Kind kind, const RequestPointer& request);
  void RunTask(Kind kind);
  void RunOptimization(const OptimizationRequest& request);
  void Refuse(const absl::Status& status, const RequestPointer& request);
  void EndTask(const absl::Status& status, bool is_refused, Kind kind);
  absl::Status Run(Kind kind);

  const TrackingEnvironment& environment_;
  const std::string name_;
  const std::string client_;  // whose turns the work takes
  const std::shared_ptr<TraverseJournal> journal_;
  const std::unique_ptr<TraverseTasks> tasks_;  // used by the task that is out, else with the mutex held
  const std::stop_source closing_;

  std::mutex mutex_;
  std::condition_variable idle_;
  OptimizationRequests requests_;
  std::stop_source preemption_;  // of the task that is out, where it gives way to a new scan
  bool is_working_ = false;      // a task is out, or is about to be
  bool is_waiting_ = false;      // until a refused or failed task is tried again
  bool is_closed_ = false;
  bool is_to_forget_ = false;  // a call that looks whether to forget what was read is waiting
  std::chrono::steady_clock::time_point last_work_;
  int num_failures_ = 0;                // in a row
  std::array<int, 2> num_preempted_{};  // in a row, of looks around and of revisions
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_SCHEDULER_H_
