// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_tasks.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "core/base/parallel.h"
#include "server/tracking/traverse_conversion.h"
#include "wire/duration.h"
#include "wire/timestamp.h"

namespace curvereg::server {

TraverseTasks::TraverseTasks(const TrackingEnvironment& environment, const TrackingOptions& options,
                             std::shared_ptr<TraverseJournal> journal, std::shared_ptr<TraverseWatchers> watchers)
    : environment_(environment),
      num_threads_(options.registration.num_threads),
      journal_(std::move(journal)),
      watchers_(std::move(watchers)),
      name_(journal_->record().traverse.name()),
      work_(environment, options) {}

// Runs `task` within the thread limit on the traverse, read from the database unless it is there.
absl::Status TraverseTasks::OnLoaded(const std::function<absl::Status()>& task) {
  const absl::StatusOr<MemoryBudget::Reservation> reservation =
      environment_.scans.memory->Reserve(2 * PreparationBytes(0));
  if (!reservation.ok()) return reservation.status();
  absl::Status status = work_.Load(journal_->record());
  if (!status.ok()) return status;
  WithThreadLimit(num_threads_, [&] { status = task(); });
  return status;
}

absl::Status TraverseTasks::Track(bool must_end, const Stop& stop) {
  return OnLoaded([&] { return TrackNext(must_end, stop); });
}

absl::Status TraverseTasks::TrackNext(bool must_end, const Stop& stop) {
  const TraverseRecord before = journal_->record();
  const absl::StatusOr<std::optional<AcknowledgedScan>> scan =
      environment_.store->FindScan(before.number, before.traverse.registered_scan_count());
  if (!scan.ok()) return scan.status();
  if (!scan->has_value()) return absl::InternalError("an acknowledged scan is not in the database");
  const absl::StatusOr<TraverseStep> step = work_.Track(**scan, must_end, stop);
  if (!step.ok()) return step.status();
  absl::Status kept = Keep(*step);
  if (kept.ok()) Publish(*step);
  return kept;
}

absl::Status TraverseTasks::LookAround(bool must_end, const Stop& stop) {
  return OnLoaded([&] {
    absl::StatusOr<TraverseStep> step = work_.LookAround(must_end, stop);
    return step.ok() ? Keep(*std::move(step)) : step.status();
  });
}

absl::Status TraverseTasks::Revise(bool must_end, const Stop& stop) {
  return OnLoaded([&] {
    absl::Status revised = ReviseLoaded(stop).status();
    if (revised.ok() || (!must_end && !IsLasting(revised))) return revised;
    environment_.logger->Warning("revision_failed", {{"traverse", name_}, {"message", std::string(revised.message())}});
    is_revision_due_ = false;
    return absl::OkStatus();
  });
}

absl::StatusOr<v1::OptimizeTraverseResponse> TraverseTasks::Optimize(const v1::OptimizeTraverseRequest& request,
                                                                     const Stop& stop) {
  if (stop.Requested()) return absl::CancelledError("cancelled while waiting");
  v1::OptimizeTraverseResponse response;
  const absl::Status status = OnLoaded([&] { return OptimizeLoaded(request, stop, response); });
  if (!status.ok()) return status;
  return response;
}

absl::Status TraverseTasks::OptimizeLoaded(const v1::OptimizeTraverseRequest& request, const Stop& stop,
                                           v1::OptimizeTraverseResponse& response) {
  if (absl::Status status = LookAroundToTheEnd(stop); !status.ok()) return status;
  if (request.find_loop_closures()) {
    const absl::StatusOr<uint32_t> num_closures = CloseLoops(stop);
    if (!num_closures.ok()) return num_closures.status();
    response.set_loop_closure_count(*num_closures);
  }
  const absl::StatusOr<TraverseRevision> revision = ReviseLoaded(stop);
  if (!revision.ok()) return revision.status();
  response.set_version(journal_->record().traverse.trajectory_version());
  response.set_link_count(static_cast<uint32_t>(revision->num_links));
  response.set_rejected_link_count(static_cast<uint32_t>(revision->num_rejected_links));
  response.set_max_translation_change_m(revision->max_translation_change_m);
  response.set_unconverged(!revision->converged);
  return absl::OkStatus();
}

absl::Status TraverseTasks::LookAroundToTheEnd(const Stop& stop) {
  const auto has_unlinked_scan = [this] {
    const TraverseRecord now = journal_->record();
    return now.num_linked_scans < now.traverse.registered_scan_count();
  };
  while (has_unlinked_scan()) {
    absl::StatusOr<TraverseStep> step = work_.LookAround(false, stop);
    if (stop.Requested()) return absl::CancelledError("cancelled while looking for links");
    if (!step.ok()) break;  // to be tried again in the background
    if (const absl::Status kept = Keep(*std::move(step)); !kept.ok()) return kept;
  }
  return absl::OkStatus();
}

absl::StatusOr<uint32_t> TraverseTasks::CloseLoops(const Stop& stop) {
  absl::StatusOr<TraverseStep> step = work_.CloseLoops(stop);
  if (!step.ok()) return step.status();
  const auto num_accepted = std::count_if(step->links.begin(), step->links.end(),
                                          [](const StoredLink& link) { return link.result.verdict().accepted(); });
  const absl::Status kept = Keep(*std::move(step));
  if (!kept.ok()) return kept;
  return static_cast<uint32_t>(num_accepted);
}

absl::StatusOr<TraverseRevision> TraverseTasks::ReviseLoaded(const Stop& stop) {
  const auto start = std::chrono::steady_clock::now();
  absl::StatusOr<TraverseWork::Revised> revised = work_.Revise(stop);
  if (!revised.ok()) return revised.status();
  environment_.scans.metrics->TraverseOptimized(std::chrono::steady_clock::now() - start);
  const absl::Status kept = Keep(std::move(revised->step));
  if (!kept.ok()) return kept;
  for (const SegmentJoin& join : revised->revision.joins) {
    environment_.scans.metrics->SegmentJoined();
    environment_.logger->Info("segments_joined", {{"traverse", name_},
                                                  {"segment", static_cast<int64_t>(join.segment)},
                                                  {"joined_segment", static_cast<int64_t>(join.joined_segment)}});
  }
  return std::move(revised->revision);
}

absl::Status TraverseTasks::Keep(TraverseStep step) {
  const google::protobuf::Timestamp now = wire::TimestampOf(std::chrono::system_clock::now());
  absl::Status kept = journal_->Change(
      [&](TraverseRecord& record) {
        work_.Describe(record);
        for (v1::WatchTraverseResponse& event : step.events) {
          event.set_event(record.num_events++);
          *event.mutable_time() = now;
        }
        return environment_.store->AddStep(record, step);
      },
      TraverseClosed());
  if (!kept.ok()) {
    work_.Forget();  // it is a step ahead of the database
    return kept;
  }
  is_revision_due_ = work_.IsRevisionDue();
  environment_.scans.metrics->TraverseEvents(step.events.size());
  if (!step.events.empty()) watchers_->Wake();
  return absl::OkStatus();
}

void TraverseTasks::Publish(const TraverseStep& step) const {
  const v1::ScanResult& result = step.events.front().result();
  const double latency_s = wire::SecondsOf(result.latency()).value_or(0.0);
  environment_.scans.metrics->ScanTracked(result.pose().origin(), latency_s, work_.LastAcquisitionSeconds());
  LogFields fields = {{"traverse", name_},
                      {"sequence_number", static_cast<int64_t>(result.sequence_number())},
                      {"segment", static_cast<int64_t>(result.pose().segment())}};
  if (result.pose().origin() == v1::POSE_ORIGIN_SEGMENT_START && result.sequence_number() > 0) {
    environment_.logger->Warning("segment_begun", fields);
  } else if (result.pose().origin() == v1::POSE_ORIGIN_PRIOR) {
    environment_.logger->Warning("pose_by_prior", fields);
  }
  fields.push_back({"ms", 1e3 * latency_s});
  environment_.logger->Debug("scan_tracked", fields);
}

}  // namespace curvereg::server
