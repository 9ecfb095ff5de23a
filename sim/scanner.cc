// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/scanner.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/parallel.h"
#include "sim/random.h"

namespace curvereg::sim {
namespace {

// Turns a unit direction by two small independent angles of deviation sigma_rad.
Eigen::Vector3d Jittered(const Eigen::Vector3d& direction, double sigma_rad, RandomStream& random) {
  const Eigen::Vector3d aside = direction.unitOrthogonal();
  const double first = random.Normal();
  const double second = random.Normal();
  return (direction + sigma_rad * (first * aside + second * direction.cross(aside))).normalized();
}

// Pose of the sensor at `share` in [0, 1] of the sweep: constant speeds along an arc.
RigidTransform MovedPose(const RigidTransform& T_world_sensor, const ScanMotion& motion, double share) {
  const double seconds = share * motion.duration_s;
  const double turned = motion.yaw_rate_radps * seconds;
  const double driven = motion.forward_mps * seconds;
  // Chord of the arc: sin(x)/x and (1 - cos(x))/x.
  const double ahead = std::abs(turned) > 1e-9 ? std::sin(turned) / turned : 1.0;
  const double aside = std::abs(turned) > 1e-9 ? (1.0 - std::cos(turned)) / turned : 0.0;
  RigidTransform T_start_now = RigidTransform::Identity();
  T_start_now.translation() = driven * Eigen::Vector3d(ahead, aside, 0.0);
  T_start_now.linear() = Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T_world_sensor * T_start_now;
}

class Sweep {
 public:
  Sweep(const World& world, const RigidTransform& T_world_sensor, const ScannerOptions& options)
      : world_(world), T_world_sensor_(T_world_sensor), options_(options) {
    moving_ = options.motion.forward_mps != 0.0 || options.motion.yaw_rate_radps != 0.0;
  }

  // The return of one beam in the sensor frame, if there is one.
  std::optional<Eigen::Vector3f> Return(int beam, uint64_t key) const {
    RandomStream random(SubKey(key, static_cast<uint64_t>(beam)));
    if (options_.keep_fraction < 1.0 && random.Uniform() >= options_.keep_fraction) return std::nullopt;
    const Eigen::Vector3d reported = BeamDirection(options_.pattern, beam);
    const Eigen::Vector3d looked =
        options_.beam_jitter_rad > 0.0 ? Jittered(reported, options_.beam_jitter_rad, random) : reported;
    const RigidTransform T_world_now =
        moving_ ? MovedPose(T_world_sensor_, options_.motion, static_cast<double>(beam) / options_.pattern.num_beams())
                : T_world_sensor_;
    const Ray ray = {.origin = T_world_now.translation(), .direction = T_world_now.linear() * looked};
    const Hit hit = world_.CastRay(ray, options_.max_range_m);
    if (hit.surface == Surface::kNothing || IsLost(ray, hit, random)) return std::nullopt;
    const double range = MeasuredRange(ray, hit.range, random);
    if (range < options_.min_range_m || range > options_.max_range_m) return std::nullopt;
    return (range * reported).cast<float>();
  }

 private:
  bool IsLost(const Ray& ray, const Hit& hit, RandomStream& random) const {
    const double cosine = -ray.direction.dot(hit.normal);
    if (cosine < options_.grazing_cosine && random.Uniform() * options_.grazing_cosine > cosine) return true;
    return options_.dropout_fraction > 0.0 && random.Uniform() < options_.dropout_fraction;
  }

  double MeasuredRange(const Ray& ray, double true_range, RandomStream& random) const {
    if (options_.outlier_fraction > 0.0 && random.Uniform() < options_.outlier_fraction) {
      return random.Uniform(options_.min_range_m, 1.5 * true_range);
    }
    double range = true_range;
    if (options_.mixed_edge_fraction > 0.0 && random.Uniform() < options_.mixed_edge_fraction) {
      range = MixedRange(ray, true_range, random);
    }
    const double sigma = options_.noise_m + options_.noise_per_m * range;
    return sigma > 0.0 ? range + sigma * random.Normal() : range;
  }

  double MixedRange(const Ray& ray, double true_range, RandomStream& random) const {
    constexpr double kOtherSurface = 0.2;  // metres between two returns that a scanner takes for one
    const Ray aside = {.origin = ray.origin, .direction = Jittered(ray.direction, options_.mixed_edge_rad, random)};
    const double other = world_.CastRay(aside, options_.max_range_m).range;
    if (!std::isfinite(other) || std::abs(other - true_range) < kOtherSurface) return true_range;
    return std::lerp(true_range, other, random.Uniform());
  }

  const World& world_;
  RigidTransform T_world_sensor_;
  const ScannerOptions& options_;
  bool moving_ = false;
};

}  // namespace

Scan SimulateScan(const World& world, const RigidTransform& T_world_sensor, const ScannerOptions& options,
                  uint64_t key) {
  constexpr int kBlock = 4096;
  const Sweep sweep(world, T_world_sensor, options);
  const int num_beams = options.pattern.num_beams();
  const int num_blocks = (num_beams + kBlock - 1) / kBlock;
  std::vector<std::vector<Eigen::Vector3f>> returns(static_cast<std::size_t>(num_blocks));
  ParallelFor(num_blocks, [&](int block) {
    std::vector<Eigen::Vector3f>& points = returns[static_cast<std::size_t>(block)];
    points.reserve(kBlock);
    const int end = std::min(num_beams, (block + 1) * kBlock);
    for (int beam = block * kBlock; beam < end; ++beam) {
      if (const std::optional<Eigen::Vector3f> point = sweep.Return(beam, key)) points.push_back(*point);
    }
  });
  std::size_t total = 0;
  for (const std::vector<Eigen::Vector3f>& points : returns) total += points.size();
  Scan scan;
  scan.points.reserve(total);
  for (const std::vector<Eigen::Vector3f>& points : returns) {
    scan.points.insert(scan.points.end(), points.begin(), points.end());
  }
  return scan;
}

}  // namespace curvereg::sim
