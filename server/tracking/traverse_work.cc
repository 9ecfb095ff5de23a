// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_work.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "server/tracking/traverse_conversion.h"
#include "wire/duration.h"
#include "wire/resource_names.h"
#include "wire/timestamp.h"
#include "wire/trajectory_conversion.h"

namespace curvereg::server {
namespace {

constexpr uint64_t kScansPerRevision = 5;
constexpr uint64_t kRevisionShare = 50;  // a revision costs more the longer the traverse: then they are rarer
constexpr int kPosesPerEvent = 2000;     // an event fits into a message of 4 MB, gRPC's default limit

// A fault of the server or of the disk, as opposed to lack of memory and cancellation.
bool IsFault(const absl::Status& status) { return absl::IsInternal(status) || absl::IsUnavailable(status); }

std::vector<v1::WatchTraverseResponse> EventsOf(const TraverseRevision& revision,
                                                const std::vector<v1::TrajectoryPose>& poses, uint64_t version) {
  std::vector<v1::WatchTraverseResponse> events;
  for (const SegmentJoin& join : revision.joins) *events.emplace_back().mutable_joined() = ToWire(join);
  v1::TrajectoryRevision* told = nullptr;
  for (const v1::TrajectoryPose& pose : poses) {
    if (told == nullptr || told->poses_size() == kPosesPerEvent) {
      told = events.emplace_back().mutable_revision();
      told->set_version(version);
    }
    *told->add_poses() = pose;
  }
  return events;
}

}  // namespace

absl::Status TraverseWork::Load(const TraverseRecord& record) {
  if (is_loaded()) return absl::OkStatus();
  Forget();
  absl::Status status = ReadScans(record);
  if (!status.ok()) return status;
  const absl::StatusOr<std::vector<StoredLink>> links = environment_.store->Links(record.number);
  if (!links.ok()) return links.status();
  for (const StoredLink& link : *links) {
    absl::StatusOr<TraverseLink> read = FromStored(link);
    if (!read.ok()) return read.status();
    traverse_.links.push_back(*std::move(read));
  }
  traverse_.version = record.traverse.trajectory_version();
  traverse_.num_segments = record.num_segments_begun;
  num_linked_scans_ = record.num_linked_scans;
  num_revised_links_ = record.num_revised_links;
  num_revised_scans_ = record.num_revised_scans;
  name_ = record.traverse.name();
  optimizes_ = record.traverse.settings().optimize_on_the_fly();
  number_ = record.number;
  return absl::OkStatus();
}

absl::Status TraverseWork::ReadScans(const TraverseRecord& record) {
  const absl::StatusOr<StoredPoses> poses = environment_.store->Poses(record.number, 0, TraverseStore::kAll);
  if (!poses.ok()) return poses.status();
  for (const v1::TrajectoryPose& pose : poses->poses) {
    absl::StatusOr<TrajectoryPose> read = wire::FromWire(pose);
    if (!read.ok()) return read.status();
    traverse_.poses.push_back(*std::move(read));
  }
  absl::StatusOr<std::vector<AcknowledgedScan>> scans =
      environment_.store->Scans(record.number, 0, static_cast<int64_t>(poses->poses.size()));
  if (!scans.ok()) return scans.status();
  for (AcknowledgedScan& scan : *scans) {
    const absl::StatusOr<std::optional<Prior>> prior = PriorOf(scan.header);
    if (!prior.ok()) return prior.status();
    traverse_.priors.push_back(*prior);
    scan_ids_.push_back(std::move(scan.scan_id));
  }
  if (scan_ids_.size() == traverse_.poses.size()) return absl::OkStatus();
  return absl::InternalError("the database of traverses has poses without scans");
}

void TraverseWork::Forget() {
  number_ = 0;
  traverse_ = Traverse();
  scan_ids_ = std::vector<std::string>();
}

TraverseScanLoader TraverseWork::Loader(TraverseScans& scans) const {
  return [this, &scans](uint64_t sequence_number,
                        const Stop& stop) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    if (sequence_number >= scan_ids_.size()) return absl::NotFoundError("no scan of that number");
    absl::StatusOr<std::shared_ptr<const PreparedScan>> scan = scans.Load(scan_ids_[sequence_number], stop);
    if (IsLasting(scan.status())) return absl::NotFoundError("a scan cannot be used");  // said when it was tracked
    return scan;
  };
}

absl::StatusOr<TraverseStep> TraverseWork::Track(const AcknowledgedScan& scan, bool must_end, const Stop& stop) {
  TraverseScans scans(environment_.scans);
  TraverseScan next;
  next.time_ns = TimeOf(scan.header);
  const absl::StatusOr<std::optional<Prior>> prior = PriorOf(scan.header);
  if (prior.ok()) next.prior = *prior;
  const auto track = [&]() -> absl::StatusOr<TrackedScan> {
    absl::StatusOr<std::shared_ptr<const PreparedScan>> prepared = scans.Load(scan.scan_id, stop);
    if (!prepared.ok()) return prepared.status();
    next.scan = *std::move(prepared);
    return TrackScan(traverse_, next, Loader(scans), options_, stop);
  };
  absl::StatusOr<TrackedScan> tracked = track();
  if (!tracked.ok()) {
    if (!IsLasting(tracked.status()) && !(must_end && IsFault(tracked.status()))) return tracked.status();
    environment_.logger->Warning("unusable_scan", {{"traverse", name_},
                                                   {"sequence_number", static_cast<int64_t>(traverse_.poses.size())},
                                                   {"scan", wire::ScanName(scan.scan_id)},
                                                   {"message", std::string(tracked.status().message())}});
    tracked = Untracked(next);
  }
  return AddTracked(*std::move(tracked), scan, next.prior);
}

TrackedScan TraverseWork::Untracked(const TraverseScan& scan) const {
  TrackedScan tracked;
  tracked.pose = PoseWithoutLink(traverse_, scan.time_ns, scan.prior);
  if (traverse_.poses.empty()) return tracked;
  tracked.links.push_back(
      {tracked.pose.sequence_number, traverse_.poses.back().sequence_number, LinkKind::kTracking, {}});
  return tracked;
}

TraverseStep TraverseWork::AddTracked(TrackedScan tracked, const AcknowledgedScan& scan,
                                      const std::optional<Prior>& prior) {
  TraverseStep step;
  v1::ScanResult& result = *step.events.emplace_back().mutable_result();
  result = ToWire(tracked);
  *result.mutable_latency() =
      wire::ToWire(1e-9 * static_cast<double>(std::max<int64_t>(
                              wire::NanosecondsOf(std::chrono::system_clock::now()) - scan.time_ns, 0)));
  step.poses.push_back(result.pose());
  // As they come back from the database after a restart.
  if (const absl::StatusOr<TrajectoryPose> kept = wire::FromWire(result.pose()); kept.ok()) tracked.pose = *kept;
  step.links = KeepLinks(tracked.links);
  AppendScan(traverse_, tracked, prior);
  scan_ids_.push_back(scan.scan_id);
  return step;
}

std::vector<StoredLink> TraverseWork::KeepLinks(std::vector<TraverseLink>& links) const {
  std::vector<StoredLink> stored;
  for (TraverseLink& link : links) {
    environment_.scans.metrics->Registered(link.result);
    stored.push_back(ToStored(link));
    if (absl::StatusOr<TraverseLink> kept = FromStored(stored.back()); kept.ok()) link = *std::move(kept);
  }
  return stored;
}

TraverseStep TraverseWork::AddLinks(const std::vector<TraverseLink>& found) {
  TraverseStep step;
  std::vector<TraverseLink> links = found;
  step.links = KeepLinks(links);
  traverse_.links.insert(traverse_.links.end(), links.begin(), links.end());
  if (found.empty()) return step;
  v1::LinksFound& told = *step.events.emplace_back().mutable_links();
  for (const TraverseLink& link : found) *told.add_links() = ToWire(link);
  return step;
}

absl::StatusOr<TraverseStep> TraverseWork::LookAround(bool must_end, const Stop& stop) {
  TraverseScans scans(environment_.scans);
  absl::StatusOr<std::vector<TraverseLink>> links =
      FindLinks(traverse_, num_linked_scans_, Loader(scans), options_, stop);
  if (!links.ok()) {
    if (!IsLasting(links.status()) && !(must_end && IsFault(links.status()))) return links.status();
    links = std::vector<TraverseLink>();  // of a scan that cannot be used
  }
  ++num_linked_scans_;
  return AddLinks(*links);
}

absl::StatusOr<TraverseStep> TraverseWork::CloseLoops(const Stop& stop) {
  TraverseScans scans(environment_.scans);
  const absl::StatusOr<std::vector<TraverseLink>> links = FindLoopClosures(traverse_, Loader(scans), options_, stop);
  if (!links.ok()) return links.status();
  return AddLinks(*links);
}

absl::StatusOr<TraverseWork::Revised> TraverseWork::Revise(const Stop& stop) {
  absl::StatusOr<TraverseRevision> revision = ReviseTraverse(traverse_, options_, stop);
  if (!revision.ok()) return revision.status();
  if (!revision->converged) {
    environment_.logger->Warning(
        "revision_did_not_converge",
        {{"traverse", name_}, {"max_translation_change_m", revision->max_translation_change_m}});
  }
  TraverseStep step;
  for (TrajectoryPose& pose : revision->poses) {
    step.poses.push_back(wire::ToWire(pose));
    if (const absl::StatusOr<TrajectoryPose> kept = wire::FromWire(step.poses.back()); kept.ok()) pose = *kept;
  }
  ApplyRevision(traverse_, *revision);
  step.events = EventsOf(*revision, step.poses, traverse_.version);
  num_revised_links_ = traverse_.links.size();
  num_revised_scans_ = traverse_.poses.size();
  return Revised{std::move(step), *std::move(revision)};
}

bool TraverseWork::IsRevisionDue() const {
  if (!optimizes_) return false;
  bool has_news = false;
  for (uint64_t i = num_revised_links_; i < traverse_.links.size(); ++i) {
    const TraverseLink& link = traverse_.links[i];
    if (!link.result.verdict.accepted) continue;
    if (traverse_.poses[link.source].segment != traverse_.poses[link.target].segment) return true;
    has_news = has_news || link.kind != LinkKind::kTracking;
  }
  const uint64_t interval = std::max<uint64_t>(kScansPerRevision, traverse_.poses.size() / kRevisionShare);
  return has_news && traverse_.poses.size() >= num_revised_scans_ + interval;
}

double TraverseWork::LastAcquisitionSeconds() const {
  const std::vector<TrajectoryPose>& poses = traverse_.poses;
  if (poses.size() < 2) return 0.0;
  const std::optional<int64_t>& begin_ns = poses[poses.size() - 2].time_ns;
  const std::optional<int64_t>& end_ns = poses.back().time_ns;
  if (!begin_ns.has_value() || !end_ns.has_value()) return 0.0;
  // Apart, for the difference of any two times may be beyond 64 bits.
  return std::max(1e-9 * (static_cast<double>(*end_ns) - static_cast<double>(*begin_ns)), 0.0);
}

void TraverseWork::Describe(TraverseRecord& record) const {
  record.traverse.set_registered_scan_count(traverse_.poses.size());
  record.traverse.set_segment_count(static_cast<uint32_t>(CountSegments(traverse_)));
  record.traverse.set_trajectory_version(traverse_.version);
  record.traverse.set_path_length_m(PathLength(traverse_));
  record.num_segments_begun = traverse_.num_segments;
  record.num_links = traverse_.links.size();
  record.num_linked_scans = num_linked_scans_;
  record.num_revised_links = num_revised_links_;
  record.num_revised_scans = num_revised_scans_;
}

}  // namespace curvereg::server
