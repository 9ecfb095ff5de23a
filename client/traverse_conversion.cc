// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/traverse_conversion.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/remote_scan.h"
#include "wire/digest.h"
#include "wire/duration.h"
#include "wire/geometry_conversion.h"
#include "wire/options_conversion.h"
#include "wire/result_conversion.h"
#include "wire/timestamp.h"
#include "wire/trajectory_conversion.h"

namespace curvereg::internal {
namespace {

absl::Status Nonsense(absl::string_view what, const absl::Status& status) {
  return absl::InternalError(absl::StrCat("the server's ", what, ": ", status.ToString()));
}

absl::StatusOr<std::chrono::system_clock::time_point> TimePointOf(const google::protobuf::Timestamp& time) {
  const std::optional<int64_t> nanoseconds = wire::NanosecondsOf(time);
  if (!nanoseconds.has_value()) return absl::InternalError("the server's time is out of range");
  return wire::TimePointOf(*nanoseconds);
}

// The reasons through the conversion of whole results, which knows them.
absl::StatusOr<std::vector<Reason>> ReasonsOf(const v1::RegistrationSummary& summary) {
  v1::RegistrationResult bare;
  if (summary.reasons_size() == 0) return std::vector<Reason>();
  *bare.mutable_verdict()->mutable_reasons() = summary.reasons();
  const absl::StatusOr<RegistrationResult> result = wire::FromWire(bare);
  if (!result.ok()) return Nonsense("reasons", result.status());
  return result->verdict.reasons;
}

absl::Status ReadPose(const v1::RegistrationSummary& summary, LinkSummary& link) {
  if (summary.translation_size() != 0 || summary.rotation_size() != 0) {
    if (summary.translation_size() != 3 || summary.rotation_size() != 4) {
      return absl::InternalError("the server's link has part of a pose");
    }
    v1::RigidTransform T;
    T.mutable_translation()->set_x(summary.translation(0));
    T.mutable_translation()->set_y(summary.translation(1));
    T.mutable_translation()->set_z(summary.translation(2));
    T.mutable_rotation()->set_x(static_cast<double>(summary.rotation(0)));
    T.mutable_rotation()->set_y(static_cast<double>(summary.rotation(1)));
    T.mutable_rotation()->set_z(static_cast<double>(summary.rotation(2)));
    T.mutable_rotation()->set_w(static_cast<double>(summary.rotation(3)));
    const absl::StatusOr<RigidTransform> T_target_source = wire::FromWire(T);
    if (!T_target_source.ok()) return Nonsense("link", T_target_source.status());
    link.T_target_source = *T_target_source;
  }
  if (summary.sigma_size() == 0) return absl::OkStatus();
  if (summary.sigma_size() != 6) return absl::InternalError("the server's link has not 6 standard deviations");
  link.sigma = Vector6d::Zero();
  for (int i = 0; i < 6; ++i) (*link.sigma)[i] = static_cast<double>(summary.sigma(i));
  return absl::OkStatus();
}

template <typename Item, typename Message>
absl::Status ReadAll(const Message& messages, std::vector<Item>& items) {
  items.reserve(static_cast<std::size_t>(messages.size()));
  for (const auto& message : messages) {
    absl::StatusOr<Item> item = FromWire(message);
    if (!item.ok()) return item.status();
    items.push_back(*std::move(item));
  }
  return absl::OkStatus();
}

absl::StatusOr<SegmentsJoined> JoinFrom(const v1::SegmentsJoined& message) {
  const absl::StatusOr<int> segment = wire::SegmentFromWire(message.segment());
  if (!segment.ok()) return Nonsense("joined segments", segment.status());
  const absl::StatusOr<int> joined = wire::SegmentFromWire(message.joined_segment());
  if (!joined.ok()) return Nonsense("joined segments", joined.status());
  const absl::StatusOr<RigidTransform> T_segment_joined = wire::FromWire(message.t_segment_joined());
  if (!T_segment_joined.ok()) return Nonsense("joined segments", T_segment_joined.status());
  return SegmentsJoined{*segment, *joined, *T_segment_joined};
}

absl::Status ReadWhat(const v1::WatchTraverseResponse& message, TraverseEvent& event) {
  switch (message.what_case()) {
    case v1::WatchTraverseResponse::kResult: {
      absl::StatusOr<curvereg::ScanResult> result = FromWire(message.result());
      if (result.ok()) event.what = *std::move(result);
      return result.status();
    }
    case v1::WatchTraverseResponse::kRevision: {
      TrajectoryRevision revision{message.revision().version(), {}};
      const absl::Status read = ReadAll(message.revision().poses(), revision.poses);
      event.what = std::move(revision);
      return read;
    }
    case v1::WatchTraverseResponse::kJoined: {
      const absl::StatusOr<SegmentsJoined> joined = JoinFrom(message.joined());
      if (joined.ok()) event.what = *joined;
      return joined.status();
    }
    case v1::WatchTraverseResponse::kLinks: {
      LinksFound found;
      const absl::Status read = ReadAll(message.links().links(), found.links);
      event.what = std::move(found);
      return read;
    }
    case v1::WatchTraverseResponse::WHAT_NOT_SET:
      break;
  }
  return absl::InternalError("the server's event says nothing that this program knows");
}

}  // namespace

v1::TraverseSettings ToWire(const TraverseSettings& settings) {
  v1::TraverseSettings message;
  *message.mutable_registration() = wire::ToWire(settings.registration);
  message.mutable_registration()->clear_prior();
  message.set_reorder_window(static_cast<uint32_t>(settings.reorder_window));
  message.set_optimize_on_the_fly(settings.optimize_on_the_fly);
  return message;
}

absl::StatusOr<RemoteTraverse> FromWire(const v1::Traverse& traverse) {
  RemoteTraverse result;
  result.name = traverse.name();
  const absl::StatusOr<RegistrationOptions> registration = wire::FromWire(traverse.settings().registration(), 0);
  if (!registration.ok()) return Nonsense("settings of a traverse", registration.status());
  result.settings.registration = *registration;
  result.settings.reorder_window = static_cast<int>(traverse.settings().reorder_window());
  result.settings.optimize_on_the_fly = traverse.settings().optimize_on_the_fly();
  const auto create_time = TimePointOf(traverse.create_time());
  if (!create_time.ok()) return create_time.status();
  result.create_time = *create_time;
  result.next_sequence_number = traverse.next_sequence_number();
  result.num_registered_scans = traverse.registered_scan_count();
  result.num_segments = static_cast<int>(traverse.segment_count());
  result.trajectory_version = traverse.trajectory_version();
  result.path_length_m = traverse.path_length_m();
  return result;
}

absl::StatusOr<curvereg::TrajectoryPose> FromWire(const v1::TrajectoryPose& pose) {
  absl::StatusOr<curvereg::TrajectoryPose> result = wire::FromWire(pose);
  if (!result.ok()) return Nonsense("pose", result.status());
  return result;
}

absl::StatusOr<LinkSummary> FromWire(const v1::TraverseLink& link) {
  const v1::RegistrationSummary& summary = link.summary();
  LinkSummary result;
  result.source = link.source_sequence_number();
  result.target = link.target_sequence_number();
  result.loop_closure = link.loop_closure();
  result.accepted = summary.accepted();
  absl::StatusOr<std::vector<Reason>> reasons = ReasonsOf(summary);
  if (!reasons.ok()) return reasons.status();
  result.reasons = *std::move(reasons);
  if (const absl::Status read = ReadPose(summary, result); !read.ok()) return read;
  if (summary.has_overlap()) result.overlap = static_cast<double>(summary.overlap());
  if (summary.has_residual_rmse_m()) result.residual_rmse_m = static_cast<double>(summary.residual_rmse_m());
  if (summary.has_runner_up_ratio()) result.runner_up_ratio = static_cast<double>(summary.runner_up_ratio());
  result.seconds = summary.total_ms() * 1e-3;
  return result;
}

absl::StatusOr<curvereg::ScanResult> FromWire(const v1::ScanResult& message) {
  curvereg::ScanResult result;
  result.sequence_number = message.sequence_number();
  absl::StatusOr<curvereg::TrajectoryPose> pose = FromWire(message.pose());
  if (!pose.ok()) return pose.status();
  result.pose = *std::move(pose);
  if (const absl::Status read = ReadAll(message.links(), result.links); !read.ok()) return read;
  if (message.has_result()) {
    absl::StatusOr<RegistrationResult> registration = wire::FromWire(message.result());
    if (!registration.ok()) return Nonsense("result", registration.status());
    result.result = *std::move(registration);
  }
  result.latency_s = wire::SecondsOf(message.latency()).value_or(0.0);
  return result;
}

absl::StatusOr<TraverseEvent> FromWire(const v1::WatchTraverseResponse& message) {
  TraverseEvent event;
  event.number = message.event();
  const auto time = TimePointOf(message.time());
  if (!time.ok()) return time.status();
  event.time = *time;
  const absl::Status read = ReadWhat(message, event);
  if (!read.ok()) return read;
  return event;
}

OptimizationOutcome FromWire(const v1::OptimizeTraverseResponse& response) {
  return {response.version(),
          static_cast<int>(response.link_count()),
          static_cast<int>(response.loop_closure_count()),
          static_cast<int>(response.rejected_link_count()),
          response.max_translation_change_m(),
          !response.unconverged()};
}

absl::StatusOr<EncodedScan> Encode(const StreamedScan& scan, const TransferEncoding& encoding) {
  absl::StatusOr<v1::PointCloud> cloud = EncodeFor(encoding, scan.scan);
  if (!cloud.ok()) return cloud.status();
  EncodedScan encoded;
  encoded.payload = std::move(*cloud->mutable_data());
  v1::StreamedScanHeader& header = encoded.header;
  header.set_sequence_number(scan.sequence_number);
  *header.mutable_header() = std::move(*cloud->mutable_header());
  header.mutable_header()->set_frame_id(scan.frame_id);
  if (scan.time_ns) *header.mutable_header()->mutable_time() = wire::TimestampOf(*scan.time_ns);
  header.set_payload_bytes(encoded.payload.size());
  *header.mutable_payload_digest() = wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, encoded.payload);
  if (scan.prior) {
    *header.mutable_prior()->mutable_t_target_source() = wire::ToWire(scan.prior->T_target_source);
    if (scan.prior->covariance) *header.mutable_prior()->mutable_covariance() = wire::ToWire(*scan.prior->covariance);
  }
  return encoded;
}

}  // namespace curvereg::internal
