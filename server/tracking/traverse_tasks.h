// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The pieces of work on one traverse. Each computes a step, writes it to the database and tells those who watch; where
// it fails, nothing has changed and the same may be tried again. They reserve memory, read the traverse when it is not
// there, and use the threads that its settings allow. One at a time.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_TASKS_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_TASKS_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/mapping/tracking.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/tracking/tracking_environment.h"
#include "server/tracking/traverse_journal.h"
#include "server/tracking/traverse_watchers.h"
#include "server/tracking/traverse_work.h"

namespace curvereg::server {

// All but Optimize: errors MEMORY_BUDGET, STORAGE_FULL, STORAGE_FAULT; CANCELLED by `stop` or after the journal was
// closed. With `must_end` the task gives up what has failed, so that the next one can follow.
class TraverseTasks {
 public:
  // `environment` outlives it.
  TraverseTasks(const TrackingEnvironment& environment, const TrackingOptions& options,
                std::shared_ptr<TraverseJournal> journal, std::shared_ptr<TraverseWatchers> watchers);

  // The pose of the next acknowledged scan. Precondition: there is one.
  absl::Status Track(bool must_end, const Stop& stop);
  // Further links of the next tracked scan that has none. Precondition: there is one.
  absl::Status LookAround(bool must_end, const Stop& stop);
  absl::Status Revise(bool must_end, const Stop& stop);
  // Links that are still to be looked for, loop closures if they are wanted, then a revision. Keeps what was found
  // before an error.
  absl::StatusOr<v1::OptimizeTraverseResponse> Optimize(const v1::OptimizeTraverseRequest& request, const Stop& stop);

  // As of the last task: found links call for a revision.
  bool is_revision_due() const { return is_revision_due_; }
  // Frees what was read of the traverse; the next task reads it again.
  void Forget() { work_.Forget(); }

 private:
  absl::Status OnLoaded(const std::function<absl::Status()>& task);
  absl::Status TrackNext(bool must_end, const Stop& stop);
  absl::Status OptimizeLoaded(const v1::OptimizeTraverseRequest& request, const Stop& stop,
                              v1::OptimizeTraverseResponse& response);
  // An optimisation without the links that are still to be looked for would not be the best.
  absl::Status LookAroundToTheEnd(const Stop& stop);
  absl::StatusOr<uint32_t> CloseLoops(const Stop& stop);
  absl::StatusOr<TraverseRevision> ReviseLoaded(const Stop& stop);
  absl::Status Keep(TraverseStep step);
  void Publish(const TraverseStep& step) const;

  const TrackingEnvironment& environment_;
  const int num_threads_;
  const std::shared_ptr<TraverseJournal> journal_;
  const std::shared_ptr<TraverseWatchers> watchers_;
  const std::string name_;
  TraverseWork work_;
  bool is_revision_due_ = false;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_TASKS_H_
