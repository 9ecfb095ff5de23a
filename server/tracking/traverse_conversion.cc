// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_conversion.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/methods/registration_names.h"
#include "core/register_scans.h"
#include "server/store/scan_identity.h"
#include "wire/error.h"
#include "wire/geometry_conversion.h"
#include "wire/options_conversion.h"
#include "wire/result_conversion.h"
#include "wire/timestamp.h"
#include "wire/trajectory_conversion.h"

namespace curvereg::server {
namespace {

constexpr uint32_t kMaxReorderWindow = 64;

}  // namespace

absl::Status TraverseNotFound(const std::string& name) {
  return wire::MakeError(v1::ERROR_REASON_TRAVERSE_NOT_FOUND, absl::StrCat("no traverse of the name ", name));
}

absl::Status TraverseClosed() {
  return wire::MakeError(v1::ERROR_REASON_CANCELLED, "the traverse was closed or deleted");
}

absl::StatusOr<TrackingOptions> FromWire(const v1::TraverseSettings& settings, int max_threads) {
  if (settings.registration().has_prior()) {
    return wire::FieldError("registration.prior", "priors come with the scans of a traverse");
  }
  if (settings.reorder_window() > kMaxReorderWindow) {
    return wire::FieldError("reorder_window", absl::StrCat("must be at most ", kMaxReorderWindow));
  }
  absl::StatusOr<RegistrationOptions> registration = wire::FromWire(settings.registration(), max_threads);
  if (!registration.ok()) return wire::WithinField("registration", registration.status());
  if (!IsAvailable(registration->method)) {
    return wire::MakeError(v1::ERROR_REASON_METHOD_UNAVAILABLE,
                           absl::StrCat("this build leaves out ", std::string(MethodName(registration->method))));
  }
  TrackingOptions options;
  options.registration = *std::move(registration);
  options.pose_graph.num_threads = options.registration.num_threads;
  return options;
}

absl::StatusOr<std::optional<Prior>> PriorOf(const v1::StreamedScanHeader& header) {
  if (!header.has_prior()) return std::nullopt;
  // Checked as that of a registration, of which it becomes one.
  v1::RegistrationOptions options;
  *options.mutable_prior() = header.prior();
  absl::StatusOr<RegistrationOptions> read = wire::FromWire(options, 0);
  if (!read.ok()) return read.status();
  return std::move(read->prior);
}

std::optional<int64_t> TimeOf(const v1::StreamedScanHeader& header) {
  if (!header.header().has_time()) return std::nullopt;
  return wire::NanosecondsOf(header.header().time());
}

v1::TraverseLink ToWire(const TraverseLink& link) {
  v1::TraverseLink message;
  message.set_source_sequence_number(link.source);
  message.set_target_sequence_number(link.target);
  *message.mutable_summary() = wire::ToSummary(link.result);
  message.set_loop_closure(link.kind == LinkKind::kLoopClosure);
  return message;
}

StoredLink ToStored(const TraverseLink& link) {
  StoredLink stored{link.source, link.target, link.kind, wire::ToWire(link.result)};
  stored.result.clear_stage_times();
  if (wire::FromWire(stored.result).ok()) return stored;
  stored.result.clear_covariance();
  stored.result.clear_degenerate_directions();
  if (!wire::FromWire(stored.result).ok()) stored.result = wire::ToWire(RegistrationResult());
  return stored;
}

absl::StatusOr<TraverseLink> FromStored(const StoredLink& link) {
  absl::StatusOr<RegistrationResult> result = wire::FromWire(link.result);
  if (!result.ok()) return result.status();
  return TraverseLink{link.source, link.target, link.kind, *std::move(result)};
}

v1::ScanResult ToWire(const TrackedScan& tracked) {
  v1::ScanResult message;
  message.set_sequence_number(tracked.pose.sequence_number);
  *message.mutable_pose() = wire::ToWire(tracked.pose);
  for (const TraverseLink& link : tracked.links) *message.add_links() = ToWire(link);
  if (tracked.deciding_link >= 0) {
    *message.mutable_result() = wire::ToWire(tracked.links[static_cast<size_t>(tracked.deciding_link)].result);
  }
  return message;
}

v1::SegmentsJoined ToWire(const SegmentJoin& join) {
  v1::SegmentsJoined message;
  message.set_segment(static_cast<uint32_t>(join.segment));
  message.set_joined_segment(static_cast<uint32_t>(join.joined_segment));
  *message.mutable_t_segment_joined() = wire::ToWire(join.T_segment_joined);
  return message;
}

double PathLength(const Traverse& traverse) {
  double length_m = 0.0;
  for (size_t i = 1; i < traverse.poses.size(); ++i) {
    const TrajectoryPose& before = traverse.poses[i - 1];
    const TrajectoryPose& pose = traverse.poses[i];
    if (before.segment != pose.segment) continue;
    length_m += (pose.T_segment_scan.translation() - before.T_segment_scan.translation()).norm();
  }
  return length_m;
}

int CountSegments(const Traverse& traverse) {
  std::set<int> segments;
  for (const TrajectoryPose& pose : traverse.poses) segments.insert(pose.segment);
  return static_cast<int>(segments.size());
}

}  // namespace curvereg::server
