// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Tiny worlds with exact geometry, scanned as a spinning scanner would: one beam after another, with occlusion and
// noise along the beam. World frame: z up, metres. The same arguments give the same points on every machine.
#ifndef CURVEREG_TESTS_TESTING_SCENES_H_
#define CURVEREG_TESTS_TESTING_SCENES_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/scan/scan.h"

namespace curvereg::testing {

// Small numbers for the noise, independent of the standard library's distributions.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}
  double Uniform();  // [0, 1)
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  double Gaussian();  // mean 0, variance 1

 private:
  uint64_t state_;
};

struct ScannerOptions {
  int num_columns = 720;             // beams per turn about the sensor's z axis
  int num_rows = 48;                 // rings, evenly spaced in elevation
  double min_elevation_rad = -0.75;  // against the sensor's xy plane
  double max_elevation_rad = 0.15;
  double max_range_m = 30.0;  // farther surfaces give no return
  double noise_m = 0.005;     // standard deviation of the range
  uint64_t noise_seed = 1;
  uint64_t world_seed = 1;  // BumpyGround: which of many worlds
};

// Upright sensor at (x, y), turned by `yaw_rad`, T_world_sensor; `height_m` above z = 0.
RigidTransform UprightPose(double x, double y, double yaw_rad, double height_m = 1.6);

// The same, `height_m` above BumpyGround, and tilted a little, as a rover would stand.
RigidTransform RoverPose(double x, double y, double yaw_rad, double height_m = 1.6, uint64_t world_seed = 1);

// Smooth hills and hollows of up to 0.8 m on a gentle swell, and boulders (spheres, 0.2 to 0.7 m), within 40 m of the
// world's origin.
double BumpyHeight(double x, double y, uint64_t world_seed = 1);  // without boulders
Scan BumpyGround(const RigidTransform& T_world_sensor, const ScannerOptions& options = {});

// The plane z = 0 without anything on it.
Scan FlatGround(const RigidTransform& T_world_sensor, const ScannerOptions& options = {});

// A hall, x in [-7, 7], y in [-5, 5], z in [0, 4], with cupboards and tables (boxes) that have no symmetry.
Scan FurnishedHall(const RigidTransform& T_world_sensor, const ScannerOptions& options = {});

// `num_points` evenly strewn over the square of side `side_m` about `centre` with normal `normal`, displaced along the
// normal by Gaussian noise.
struct PlanePatch {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double side_m = 1.0;
  double noise_m = 0.0;
};
std::vector<Eigen::Vector3f> PatchPoints(const PlanePatch& patch, int num_points, uint64_t seed);

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_SCENES_H_
