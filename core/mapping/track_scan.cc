// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/track_scan.h"

#include <algorithm>
#include <utility>

#include "core/mapping/link_registration.h"
#include "core/mapping/pose_uncertainty.h"

namespace curvereg {
namespace {

void Place(const TrajectoryPose& target, const Prior& T_target_scan, PoseOrigin origin, TrajectoryPose& pose) {
  const Prior T_segment_scan = Chained({target.T_segment_scan, target.covariance}, T_target_scan);
  pose.segment = target.segment;
  pose.T_segment_scan = Orthonormalised(T_segment_scan.T_target_source);
  pose.covariance = T_segment_scan.covariance;
  pose.origin = origin;
}

class ScanTracker {
 public:
  ScanTracker(const Traverse& traverse, const TraverseScan& scan, const TraverseScanLoader& load,
              const TrackingOptions& options, const Stop& stop)
      : traverse_(traverse), scan_(scan), load_(load), options_(options), stop_(stop) {}

  absl::StatusOr<TrackedScan> Run() {
    tracked_.pose.sequence_number = traverse_.poses.size();
    tracked_.pose.time_ns = scan_.time_ns;
    if (traverse_.poses.empty()) return Unlinked();
    const absl::StatusOr<bool> is_linked = TryLink(Predecessor(), scan_.prior);
    if (!is_linked.ok()) return is_linked.status();
    if (*is_linked) return std::move(tracked_);
    const size_t most = tracked_.links.size() + static_cast<size_t>(std::max(0, options_.num_tracking_neighbours));
    for (const uint64_t target : TargetsBesidePredecessor()) {
      if (tracked_.links.size() >= most || num_not_kept_ >= kMaxNotKept) break;
      const TrajectoryPose& pose = traverse_.poses[target];
      const absl::StatusOr<bool> is_neighbour_linked = TryLink(pose, MotionSince(pose));
      if (!is_neighbour_linked.ok()) return is_neighbour_linked.status();
      if (*is_neighbour_linked) return std::move(tracked_);
    }
    return Unlinked();
  }

 private:
  const TrajectoryPose& Predecessor() const { return traverse_.poses.back(); }

  // Motion since the predecessor: as told, else as before, which is a guess and no more. It serves to find other scans
  // when the predecessor's link was rejected; as one more hypothesis of that link it cost a tenth and changed nothing.
  std::optional<Prior> Motion() const {
    if (scan_.prior.has_value() || traverse_.poses.size() < 2) return scan_.prior;
    const TrajectoryPose& before = traverse_.poses[traverse_.poses.size() - 2];
    if (before.segment != Predecessor().segment) return std::nullopt;
    return Prior{before.T_segment_scan.inverse() * Predecessor().T_segment_scan, std::nullopt};
  }

  std::optional<Prior> MotionSince(const TrajectoryPose& target) const {
    const std::optional<Prior> motion = Motion();
    if (!motion.has_value() || target.segment != Predecessor().segment) return std::nullopt;
    return Chained(RelativePose(target, Predecessor()), *motion);
  }

  // The scans nearest to where the scan probably is. A segment that has only just begun gives too few; then also the
  // last scans before it, so that one unusable scan does not cut the traverse in two. Which of them are kept, and so
  // can be tried, turns out when they are loaded.
  std::vector<uint64_t> TargetsBesidePredecessor() const {
    const std::optional<Prior> motion = Motion();
    const RigidTransform T_segment_scan =
        Predecessor().T_segment_scan * (motion.has_value() ? motion->T_target_source : RigidTransform::Identity());
    std::vector<std::pair<double, uint64_t>> by_distance;
    for (const TrajectoryPose& pose : traverse_.poses) {
      if (pose.segment != Predecessor().segment || pose.sequence_number == Predecessor().sequence_number) continue;
      const double distance_m = (pose.T_segment_scan.translation() - T_segment_scan.translation()).norm();
      if (distance_m <= options_.max_neighbour_distance_m) by_distance.emplace_back(distance_m, pose.sequence_number);
    }
    std::sort(by_distance.begin(), by_distance.end());
    std::vector<uint64_t> targets;
    for (const auto& [distance_m, number] : by_distance) targets.push_back(number);
    for (uint64_t number = Predecessor().sequence_number; number-- > 0;) {
      if (traverse_.poses[number].segment != Predecessor().segment) targets.push_back(number);
    }
    return targets;
  }

  // True when the link was accepted and gave the pose.
  absl::StatusOr<bool> TryLink(const TrajectoryPose& target, const std::optional<Prior>& prior) {
    const LinkRequest request{tracked_.pose.sequence_number, target.sequence_number, LinkKind::kTracking, prior};
    absl::StatusOr<TraverseLink> link = RegisterLink(*scan_.scan, request, load_, options_.registration, stop_);
    if (absl::IsNotFound(link.status())) {
      ++num_not_kept_;
      return false;
    }
    if (!link.ok()) return link.status();
    const RegistrationResult& result = link->result;
    const bool is_accepted = result.verdict.accepted;
    if (is_accepted) {
      Place(target, {*result.T_target_source, LinkCovariance(result, options_.pose_graph)}, PoseOrigin::kRegistered,
            tracked_.pose);
      tracked_.deciding_link = static_cast<int>(tracked_.links.size());
    }
    tracked_.links.push_back(*std::move(link));
    return is_accepted;
  }

  TrackedScan Unlinked() {
    tracked_.pose = PoseWithoutLink(traverse_, scan_.time_ns, scan_.prior);
    return std::move(tracked_);
  }

  const Traverse& traverse_;
  const TraverseScan& scan_;
  const TraverseScanLoader& load_;
  const TrackingOptions& options_;
  const Stop& stop_;
  TrackedScan tracked_;
  int num_not_kept_ = 0;  // scans passed over
};

}  // namespace

TrajectoryPose PoseWithoutLink(const Traverse& traverse, const std::optional<int64_t>& time_ns,
                               const std::optional<Prior>& prior) {
  TrajectoryPose pose;
  pose.sequence_number = traverse.poses.size();
  pose.time_ns = time_ns;
  if (!traverse.poses.empty() && prior.has_value() && prior->covariance.has_value()) {
    Place(traverse.poses.back(), *prior, PoseOrigin::kPrior, pose);
    return pose;
  }
  pose.segment = traverse.num_segments;
  pose.covariance = Matrix6d::Zero();
  pose.origin = PoseOrigin::kSegmentStart;
  return pose;
}

absl::StatusOr<TrackedScan> TrackScan(const Traverse& traverse, const TraverseScan& scan,
                                      const TraverseScanLoader& load, const TrackingOptions& options,
                                      const Stop& stop) {
  if (scan.scan == nullptr) return absl::InvalidArgumentError("a traverse needs scans");
  return ScanTracker(traverse, scan, load, options, stop).Run();
}

}  // namespace curvereg
