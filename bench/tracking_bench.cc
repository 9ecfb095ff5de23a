// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a traverse adds to a registration: preparing and tracking a new scan at scan 10 and at scan 1,000, with and
// without odometry, beside preparing it and registering it on its prepared predecessor. Scans of mars-yard-sim, in
// turn.
#include <cstdio>
#include <memory>
#include <vector>

#include "bench/median_time.h"
#include "core/base/parallel.h"
#include "core/mapping/tracking.h"
#include "core/register_scans.h"
#include "sim/presets.h"
#include "sim/random.h"
#include "sim/simulation.h"

namespace curvereg {
namespace {

constexpr uint64_t kNumScans = 10;

struct Drive {
  std::vector<std::shared_ptr<const Scan>> scans;
  std::vector<std::shared_ptr<const PreparedScan>> prepared;
  std::vector<RigidTransform> T_world_scan;
};

Drive MakeDrive() {
  const auto simulation = sim::Simulation::Create(*sim::PresetOptions("mars-yard-sim"));
  Drive drive;
  for (uint64_t i = 0; i < kNumScans; ++i) {
    drive.scans.push_back(std::make_shared<Scan>(simulation->ScanAt(static_cast<int>(i))));
    drive.prepared.push_back(*PreparedScan::Create(drive.scans.back()));
    static_cast<void>(drive.prepared.back()->View(BirdsEyeView::kElevation, 0));
    drive.T_world_scan.push_back(simulation->T_world_scan(static_cast<int>(i)));
  }
  return drive;
}

// An accepted link that is off by a millimetre and a twentieth of a milliradian per axis.
TraverseLink NoisyLink(const TrajectoryPose& source, const TrajectoryPose& target, sim::RandomStream& random) {
  Vector6d sigmas;
  sigmas << 5e-5, 5e-5, 5e-5, 1e-3, 1e-3, 1e-3;
  Vector6d error;
  for (int i = 0; i < 6; ++i) error[i] = sigmas[i] * random.Normal();
  TraverseLink link{source.sequence_number, target.sequence_number, LinkKind::kTracking, {}};
  link.result.T_target_source = TransformFromVector(error) * target.T_segment_scan.inverse() * source.T_segment_scan;
  link.result.covariance = sigmas.array().square().matrix().asDiagonal();
  link.result.verdict = {true, {}};
  return link;
}

// `num_poses` poses, of which scan i is the drive's scan i modulo kNumScans, with four links each.
Traverse LongTraverse(const Drive& drive, uint64_t num_poses) {
  Traverse traverse;
  sim::RandomStream random(1);
  for (uint64_t number = 0; number < num_poses; ++number) {
    TrackedScan tracked;
    tracked.pose.sequence_number = number;
    tracked.pose.T_segment_scan = drive.T_world_scan[number % kNumScans];
    tracked.pose.covariance = 1e-6 * static_cast<double>(number) * Matrix6d::Identity();
    for (uint64_t k = 1; k <= 4 && k <= number; ++k) {
      tracked.links.push_back(NoisyLink(tracked.pose, traverse.poses[number - k], random));
    }
    AppendScan(traverse, tracked, std::nullopt);
  }
  return traverse;
}

class TrackingBench {
 public:
  bool accepted() const { return accepted_; }

  void RegisterPair(int num_threads) {
    RegistrationOptions options;
    options.num_threads = num_threads;
    const uint64_t i = Next();
    const std::shared_ptr<const PreparedScan> source = Prepare(i, num_threads);
    Note(RegisterPreparedScans(*source, *drive_.prepared[i - 1], options)->verdict.accepted);
  }

  void Track(Traverse& traverse, bool with_odometry, int num_threads) {
    TrackingOptions options;
    options.registration.num_threads = num_threads;
    const uint64_t i = Next();
    // The last pose stands for the drive's scan i - 1.
    traverse.poses.back().T_segment_scan = drive_.T_world_scan[i - 1];
    TraverseScan scan{Prepare(i, num_threads), std::nullopt, std::nullopt};
    if (with_odometry) {
      scan.prior =
          Prior{drive_.T_world_scan[i - 1].inverse() * drive_.T_world_scan[i], Matrix6d(0.01 * Matrix6d::Identity())};
    }
    const auto load = [&](uint64_t, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
      return drive_.prepared[i - 1];
    };
    Note(TrackScan(traverse, scan, load, options)->deciding_link == 0);
  }

  Traverse Long(uint64_t num_poses) const { return LongTraverse(drive_, num_poses); }

 private:
  uint64_t Next() { return 1 + round_++ / kWorks % (kNumScans - 1); }
  void Note(bool accepted) { accepted_ = accepted_ && accepted; }

  std::shared_ptr<const PreparedScan> Prepare(uint64_t i, int num_threads) const {
    std::shared_ptr<const PreparedScan> prepared;
    WithThreadLimit(num_threads, [&] { prepared = *PreparedScan::Create(drive_.scans[i]); });
    return prepared;
  }

  static constexpr uint64_t kWorks = 5;  // all meet the same pair
  Drive drive_ = MakeDrive();
  uint64_t round_ = 0;
  bool accepted_ = true;
};

int Main() {
  constexpr int kRounds = 27;  // each pair of the drive three times
  TrackingBench bench;
  Traverse at_10 = bench.Long(10);
  Traverse at_1000 = bench.Long(1000);
  std::printf("medians of %d rounds, processor time of the calling thread\n", kRounds);
  std::printf("%8s %-32s %9s %8s\n", "threads", "work", "ms", "ratio");
  for (const int threads : {1, 2}) {
    const std::vector<double> seconds = bench::MedianSeconds(
        kRounds, {[&] { bench.RegisterPair(threads); }, [&] { bench.Track(at_10, false, threads); },
                  [&] { bench.Track(at_1000, false, threads); }, [&] { bench.Track(at_10, true, threads); },
                  [&] { bench.Track(at_1000, true, threads); }});
    const char* names[] = {"a prepared pair", "scan 10 of a traverse", "scan 1,000 of a traverse",
                           "scan 10 with odometry", "scan 1,000 with odometry"};
    for (size_t i = 0; i < seconds.size(); ++i) {
      std::printf("%8d %-32s %9.2f %8.2f\n", threads, names[i], 1e3 * seconds[i], seconds[i] / seconds[0]);
    }
  }
  Traverse linked = bench.Long(1000);
  for (TrajectoryPose& pose : linked.poses) pose.covariance.reset();
  size_t num_revised = 0;
  const std::vector<double> revising = bench::MedianSeconds(3, {[&] {
                                                              TrackingOptions options;
                                                              options.pose_graph.num_threads = 1;
                                                              num_revised =
                                                                  ReviseTraverse(linked, options)->poses.size();
                                                            }});
  std::printf("revising 1,000 scans of %zu links: %.3f s, %zu poses revised\n", linked.links.size(), revising[0],
              num_revised);
  if (!bench.accepted()) std::printf("not every scan was linked with its predecessor\n");
  return bench.accepted() ? 0 : 1;
}

}  // namespace
}  // namespace curvereg

int main() { return curvereg::Main(); }
