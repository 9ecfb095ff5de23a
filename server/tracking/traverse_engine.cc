// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_engine.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/page_token.h"
#include "server/tracking/traverse_conversion.h"
#include "server/tracking/traverse_tasks.h"
#include "wire/error.h"
#include "wire/trajectory_conversion.h"

namespace curvereg::server {

absl::StatusOr<std::shared_ptr<TraverseEngine>> TraverseEngine::Open(const TrackingEnvironment& environment,
                                                                     const TraverseRecord& record,
                                                                     std::shared_ptr<TraverseWatchers> watchers) {
  Origin origin;
  absl::StatusOr<TrackingOptions> options =
      FromWire(record.traverse.settings(), environment.scans.limits.max_threads_per_registration);
  if (!options.ok()) return options.status();
  origin.options = *std::move(options);
  const absl::StatusOr<std::vector<AcknowledgedScan>> beyond =
      environment.store->Scans(record.number, record.traverse.next_sequence_number(), TraverseStore::kAll);
  if (!beyond.ok()) return beyond.status();
  for (const AcknowledgedScan& scan : *beyond) origin.early.insert(scan.header.sequence_number());
  origin.watchers = std::move(watchers);
  return std::shared_ptr<TraverseEngine>(new TraverseEngine(environment, record, std::move(origin)));
}

TraverseEngine::TraverseEngine(const TrackingEnvironment& environment, const TraverseRecord& record, Origin origin)
    : environment_(environment),
      watchers_(std::move(origin.watchers)),
      journal_(std::make_shared<TraverseJournal>(record)),
      admission_(environment, journal_, std::move(origin.early)),
      scheduler_(std::make_shared<TraverseScheduler>(
          environment, journal_, std::make_unique<TraverseTasks>(environment, origin.options, journal_, watchers_))) {}

void TraverseEngine::Close() {
  journal_->Close();
  scheduler_->Close();
}

absl::StatusOr<StreamTicket> TraverseEngine::BeginStream(const std::stop_source& owner) {
  return admission_.BeginStream(owner);
}

absl::Status TraverseEngine::CheckScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) {
  return admission_.CheckScan(ticket, header, known);
}

absl::StatusOr<uint64_t> TraverseEngine::AddScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                                 const std::string& scan_id) {
  absl::StatusOr<uint64_t> next = admission_.AddScan(ticket, header, scan_id);
  if (next.ok()) scheduler_->ScanAdded();
  return next;
}

absl::StatusOr<std::vector<v1::WatchTraverseResponse>> TraverseEngine::Events(uint64_t first_event, int max_events) {
  const TraverseRecord now = record();
  if (first_event > now.num_events) {
    return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "there is no event of that number yet",
                           {{"next_event", absl::StrCat(now.num_events)}});
  }
  return environment_.store->Events(now.number, first_event, max_events);
}

absl::StatusOr<std::vector<v1::ScanResult>> TraverseEngine::Results(uint64_t first_sequence_number, int max_results) {
  const TraverseRecord now = record();
  if (first_sequence_number >= now.traverse.registered_scan_count()) return std::vector<v1::ScanResult>();
  return environment_.store->Results(now.number, first_sequence_number, max_results);
}

std::unique_ptr<Subscription> TraverseEngine::Subscribe(std::function<void()> wake) {
  return watchers_->Add(std::move(wake));
}

absl::StatusOr<v1::GetTrajectoryResponse> TraverseEngine::Trajectory(int page_size, const std::string& page_token) {
  const absl::StatusOr<int> num_poses = PageSize(page_size, kMaxPageSize);
  if (!num_poses.ok()) return num_poses.status();
  const absl::StatusOr<int64_t> first = PlaceOf(page_token, 0);
  if (!first.ok()) return first.status();
  absl::StatusOr<StoredPoses> stored =
      environment_.store->Poses(record().number, static_cast<uint64_t>(*first), *num_poses + 1);
  if (!stored.ok()) return stored.status();
  v1::GetTrajectoryResponse response;
  response.set_version(stored->traverse.trajectory_version());
  for (v1::TrajectoryPose& pose : stored->poses) {
    if (response.poses_size() == *num_poses) {
      response.set_next_page_token(TokenOfPlace(static_cast<int64_t>(pose.sequence_number())));
      break;
    }
    *response.add_poses() = std::move(pose);
  }
  return response;
}

absl::StatusOr<SegmentScans> TraverseEngine::ScansOfSegment(uint32_t segment) {
  const TraverseRecord now = record();
  const absl::StatusOr<StoredPoses> poses = environment_.store->Poses(now.number, 0, TraverseStore::kAll);
  if (!poses.ok()) return poses.status();
  absl::StatusOr<std::vector<AcknowledgedScan>> scans =
      environment_.store->Scans(now.number, 0, static_cast<int64_t>(poses->poses.size()));
  if (!scans.ok()) return scans.status();
  if (scans->size() != poses->poses.size()) return TraverseNotFound(now.traverse.name());  // deleted meanwhile
  SegmentScans found;
  found.version = poses->traverse.trajectory_version();
  for (size_t i = 0; i < scans->size(); ++i) {
    if (poses->poses[i].segment() != segment) continue;
    const absl::StatusOr<TrajectoryPose> pose = wire::FromWire(poses->poses[i]);
    if (!pose.ok()) return pose.status();
    found.scan_ids.push_back(std::move((*scans)[i].scan_id));
    found.T_segment_scan.push_back(pose->T_segment_scan);
  }
  if (found.scan_ids.empty()) return wire::FieldError("segment", "the traverse has no such segment");
  return found;
}

void TraverseEngine::Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client, const Stop& stop,
                              OptimizeDone done) {
  scheduler_->Optimize(request, client, stop, std::move(done));
}

}  // namespace curvereg::server
