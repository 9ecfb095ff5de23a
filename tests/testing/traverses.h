// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Simulated drives tracked scan by scan, as a server would do it. Needs curvereg::mapping and curvereg::sim.
#ifndef CURVEREG_TESTS_TESTING_TRAVERSES_H_
#define CURVEREG_TESTS_TESTING_TRAVERSES_H_

#include <cmath>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/mapping/tracking.h"
#include "sim/random.h"
#include "sim/simulation.h"

namespace curvereg::testing {

// The scans of a simulation, prepared once each and kept; `scan_of` says which of them the traverse's scans are.
class DriveScans {
 public:
  DriveScans(sim::Simulation simulation, std::vector<int> scan_of)
      : simulation_(std::move(simulation)), scan_of_(std::move(scan_of)) {}
  explicit DriveScans(sim::Simulation simulation) : simulation_(std::move(simulation)) {
    for (int i = 0; i < simulation_.num_scans(); ++i) scan_of_.push_back(i);
  }

  uint64_t size() const { return scan_of_.size(); }
  const RigidTransform& T_world_scan(uint64_t number) const { return simulation_.T_world_scan(scan_of_[number]); }
  // T_target_source of the truth.
  RigidTransform TrueMotion(uint64_t target, uint64_t source) const {
    return T_world_scan(target).inverse() * T_world_scan(source);
  }

  std::shared_ptr<const PreparedScan> Get(uint64_t number) {
    std::shared_ptr<const PreparedScan>& scan = prepared_[number];
    if (scan == nullptr) {
      WithThreadLimit(
          0, [&] { scan = *PreparedScan::Create(std::make_shared<const Scan>(simulation_.ScanAt(scan_of_[number]))); });
    }
    return scan;
  }
  TraverseScanLoader Loader() {
    return [this](uint64_t number, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
      if (number >= size()) return absl::NotFoundError("no such scan");
      return Get(number);
    };
  }

  // Odometry that is off by up to `drift` of the way, and turns as much: its honest prior for scan `number` > 0.
  Prior Odometry(uint64_t number, double drift) const {
    const RigidTransform T_true = TrueMotion(number - 1, number);
    const double sigma_m = 0.02 + drift * T_true.translation().norm();
    const double sigma_rad = 0.01 + 0.2 * drift;
    sim::RandomStream random(sim::SubKey(77, number));
    Vector6d error;
    Vector6d variances;
    for (int i = 0; i < 6; ++i) {
      const double sigma = i < 3 ? sigma_rad : sigma_m;
      error[i] = sigma * random.Uniform(-1.7, 1.7);
      variances[i] = sigma * sigma;
    }
    return {TransformFromVector(error) * T_true, Matrix6d(variances.asDiagonal())};
  }

 private:
  sim::Simulation simulation_;
  std::vector<int> scan_of_;
  std::map<uint64_t, std::shared_ptr<const PreparedScan>> prepared_;
};

// A drive of small scans through the Mars yard; quick to make and to register.
inline sim::SimulationOptions SmallDrive(int num_scans) {
  sim::SimulationOptions options;
  options.num_scans = num_scans;
  options.world.yard.length_m = 80.0;
  options.scanner.pattern.columns = 360;
  options.scanner.pattern.rows = 180;
  return options;
}

// A scan of ground that no drive saw.
inline std::shared_ptr<const PreparedScan> ScanElsewhere() {
  sim::SimulationOptions options = SmallDrive(1);
  options.seed = 4711;
  DriveScans drive(*sim::Simulation::Create(options));
  return drive.Get(0);
}

// Tracks the drive's scans one after the other.
inline Traverse TrackDrive(DriveScans& drive, const TrackingOptions& options = {}) {
  Traverse traverse;
  for (uint64_t number = 0; number < drive.size(); ++number) {
    const TraverseScan scan{drive.Get(number), std::nullopt, std::nullopt};
    AppendScan(traverse, TrackScan(traverse, scan, drive.Loader(), options).value(), scan.prior);
  }
  return traverse;
}

// Distances [m] of the poses from the truth, with the first pose aligned to it.
inline std::vector<double> PositionErrors(const Traverse& traverse, const DriveScans& drive) {
  std::vector<double> errors;
  const RigidTransform T_world_segment = drive.T_world_scan(0) * traverse.poses.front().T_segment_scan.inverse();
  for (const TrajectoryPose& pose : traverse.poses) {
    const RigidTransform T_world_scan = T_world_segment * pose.T_segment_scan;
    errors.push_back((T_world_scan.translation() - drive.T_world_scan(pose.sequence_number).translation()).norm());
  }
  return errors;
}

inline double RootMeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

// Absolute trajectory error [m]: root mean square after the rigid motion that fits best (Umeyama, without scale).
inline double AbsoluteTrajectoryError(const Traverse& traverse, const DriveScans& drive) {
  const auto count = static_cast<Eigen::Index>(traverse.poses.size());
  Eigen::Matrix3Xd found(3, count);
  Eigen::Matrix3Xd truth(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    found.col(i) = traverse.poses[static_cast<size_t>(i)].T_segment_scan.translation();
    truth.col(i) = drive.T_world_scan(static_cast<uint64_t>(i)).translation();
  }
  const Eigen::Matrix4d fit = Eigen::umeyama(found, truth, false);
  const Eigen::Matrix3Xd moved = (fit.topLeftCorner<3, 3>() * found).colwise() + fit.topRightCorner<3, 1>();
  return std::sqrt((moved - truth).colwise().squaredNorm().mean());
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_TRAVERSES_H_
