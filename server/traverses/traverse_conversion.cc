// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/traverse_conversion.h"

#include <chrono>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/register_scans.h"
#include "server/scans/scan_conversion.h"
#include "server/store/scan_identity.h"
#include "wire/conversion.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr std::string_view kTraverses = "traverses/";
constexpr uint32_t kMaxReorderWindow = 64;
constexpr int kUpperTriangle = 21;  // numbers of a symmetric 6x6 matrix
constexpr int64_t kNanosecondsPerSecond = 1'000'000'000;

v1::PoseOrigin ToWire(PoseOrigin origin) {
  switch (origin) {
    case PoseOrigin::kSegmentStart:
      return v1::POSE_ORIGIN_SEGMENT_START;
    case PoseOrigin::kRegistered:
      return v1::POSE_ORIGIN_REGISTERED;
    case PoseOrigin::kPrior:
      return v1::POSE_ORIGIN_PRIOR;
  }
  return v1::POSE_ORIGIN_UNSPECIFIED;
}

absl::StatusOr<PoseOrigin> FromWire(v1::PoseOrigin origin) {
  switch (origin) {
    case v1::POSE_ORIGIN_SEGMENT_START:
      return PoseOrigin::kSegmentStart;
    case v1::POSE_ORIGIN_REGISTERED:
      return PoseOrigin::kRegistered;
    case v1::POSE_ORIGIN_PRIOR:
      return PoseOrigin::kPrior;
    default:
      return wire::FieldError("origin", "not a known origin");
  }
}

absl::StatusOr<Matrix6d> SymmetricFromWire(const v1::PoseCovariance& message) {
  if (message.upper_triangle_size() != kUpperTriangle) return wire::FieldError("covariance", "not 21 numbers");
  Matrix6d matrix;
  int next = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      matrix(row, column) = matrix(column, row) = message.upper_triangle(next++);
    }
  }
  return matrix;
}

// Nullopt: beyond what 64 bits hold, 292 years around 1970.
std::optional<int64_t> NanosecondsOf(const google::protobuf::Timestamp& time) {
  constexpr int64_t kMaxSeconds = std::numeric_limits<int64_t>::max() / kNanosecondsPerSecond - 1;
  if (time.seconds() > kMaxSeconds || time.seconds() < -kMaxSeconds) return std::nullopt;
  if (time.nanos() < 0 || time.nanos() >= kNanosecondsPerSecond) return std::nullopt;
  return time.seconds() * kNanosecondsPerSecond + time.nanos();
}

}  // namespace

std::string TraverseName(std::string_view traverse_id) { return std::string(kTraverses).append(traverse_id); }

absl::StatusOr<std::string> TraverseIdOf(std::string_view name, std::string_view field) {
  if (name.starts_with(kTraverses)) {
    std::string id(name.substr(kTraverses.size()));
    if (IsUploadId(id)) return id;
  }
  return wire::FieldError(field, "must be traverses/ and 1 to 64 of a-z, 0-9 and '-'");
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
  return NanosecondsOf(header.header().time());
}

v1::TrajectoryPose ToWire(const TrajectoryPose& pose) {
  v1::TrajectoryPose message;
  message.set_sequence_number(pose.sequence_number);
  if (pose.time_ns.has_value()) {
    *message.mutable_time() = ToWire(std::chrono::system_clock::time_point(std::chrono::nanoseconds(*pose.time_ns)));
  }
  message.set_segment(static_cast<uint32_t>(pose.segment));
  *message.mutable_t_segment_sensor() = wire::ToWire(pose.T_segment_scan);
  if (pose.covariance.has_value()) *message.mutable_covariance() = wire::ToWire(*pose.covariance);
  message.set_origin(ToWire(pose.origin));
  return message;
}

absl::StatusOr<TrajectoryPose> FromWire(const v1::TrajectoryPose& message) {
  TrajectoryPose pose;
  pose.sequence_number = message.sequence_number();
  if (message.has_time()) pose.time_ns = NanosecondsOf(message.time());
  pose.segment = static_cast<int>(message.segment());
  absl::StatusOr<RigidTransform> T_segment_scan = wire::FromWire(message.t_segment_sensor());
  if (!T_segment_scan.ok()) return wire::WithinField("t_segment_sensor", T_segment_scan.status());
  pose.T_segment_scan = *T_segment_scan;
  if (message.has_covariance()) {
    absl::StatusOr<Matrix6d> covariance = SymmetricFromWire(message.covariance());
    if (!covariance.ok()) return covariance.status();
    pose.covariance = *covariance;
  }
  const absl::StatusOr<PoseOrigin> origin = FromWire(message.origin());
  if (!origin.ok()) return origin.status();
  pose.origin = *origin;
  return pose;
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
  *message.mutable_pose() = ToWire(tracked.pose);
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
