// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/simulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "sim/random.h"

namespace curvereg::sim {
namespace {

// Streams of the seed.
enum Stream : uint64_t { kWorldStream, kDriveStream, kYawStream, kScanStream, kKindStream };

absl::StatusOr<World> MakeWorld(const WorldOptions& options, uint64_t key) {
  switch (options.kind) {
    case WorldKind::kYard:
      return MakeYardWorld(options.yard, options.relief, key);
    case WorldKind::kDome:
      return MakeDomeWorld(options.dome, options.relief, key);
    case WorldKind::kElevationModel:
      return MakeElevationWorld(options.elevation, options.relief, key);
  }
  return absl::InternalError("unknown kind of world");
}

// The world without the rocks that would stop the rover at its waypoints.
World ClearedAlong(const World& world, const std::vector<Waypoint>& stops, const RoverOptions& rover) {
  std::vector<Rock> rocks = world.rocks();
  std::erase_if(rocks, [&](const Rock& rock) {
    const double reach = rover.clearance_m + std::max(rock.half_extent.x(), rock.half_extent.y());
    return rock.half_extent.z() > 0.5 * rover.max_rock_m &&
           std::any_of(stops.begin(), stops.end(),
                       [&](const Waypoint& stop) { return (stop.place - rock.centre.head<2>()).norm() <= reach; });
  });
  return World(world.ground(), std::move(rocks), world.shell());
}

// Where the scans of one world are taken, by waypoint.
absl::StatusOr<RigidTransform> PoseAt(const World& world, const Waypoint& stop, const SimulationOptions& options,
                                      double sensor_yaw_rad) {
  const std::optional<RoverStance> stance = ParkNear(world, stop.place, stop.heading_rad, options.rover);
  if (!stance.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("no place to stand near x = %.1f m, y = %.1f m", stop.place.x(), stop.place.y()));
  }
  return SensorPose(*stance, options.rover, sensor_yaw_rad);
}

// Sensor headings whose consecutive differences fill (-pi, pi] evenly, for any seed.
std::vector<double> RandomYaws(uint64_t seed, int num_scans) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  RandomStream random(SubKey(seed, kYawStream));
  double share = random.Uniform();
  double yaw = random.Uniform(0.0, kTurn);
  std::vector<double> yaws;
  for (int i = 0; i < num_scans; ++i) {
    yaws.push_back(std::remainder(yaw, kTurn));
    share = std::fmod(share + std::numbers::phi, 1.0);
    yaw += kTurn * share;
  }
  return yaws;
}

// Yard, nearly flat yard, dome and rough ground in turn, each of its own size and shape.
SimulationOptions OptionsOfWorld(const SimulationOptions& base, int index) {
  SimulationOptions options = base;
  RandomStream random(SubKey(SubKey(base.seed, kKindStream), static_cast<uint64_t>(index)));
  const double relief = random.Uniform();
  switch (index % 4) {
    case 0:
      options.world.relief *= 0.6 + 0.8 * relief;
      break;
    case 1:
      options.world.relief *= 0.1 + 0.1 * relief;
      break;
    case 2:
      options.world.kind = WorldKind::kDome;
      options.world.dome.diameter_m *= random.Uniform(0.8, 1.25);
      options.world.dome.height_m *= random.Uniform(0.6, 1.1);
      options.traverse.shape = TraverseShape::kLoop;
      options.traverse.step_m = 2.4;
      break;
    default:
      options.world.yard.width_m = options.world.yard.length_m;
      options.world.yard.undulation.longest_wavelength_m = 80.0;
      options.world.yard.undulation.amplitude_m = 2.0 + 2.0 * relief;
      options.world.yard.num_ridges = 0;
      options.world.yard.num_craters = 3;
      break;
  }
  return options;
}

}  // namespace

absl::StatusOr<Simulation> Simulation::Create(const SimulationOptions& options) {
  if (absl::Status status = Validate(options); !status.ok()) return status;
  Simulation simulation(options);
  const uint64_t world_key = SubKey(options.seed, kWorldStream);
  const uint64_t drive_key = SubKey(options.seed, kDriveStream);
  const std::vector<double> yaws = RandomYaws(options.seed, options.num_scans);
  const int num_worlds = options.separate_worlds ? options.num_scans : 1;
  for (int i = 0; i < num_worlds; ++i) {
    const SimulationOptions own = options.separate_worlds ? OptionsOfWorld(options, i) : options;
    absl::StatusOr<World> world = MakeWorld(own.world, SubKey(world_key, static_cast<uint64_t>(i)));
    if (!world.ok()) return world.status();
    const absl::StatusOr<std::vector<Waypoint>> stops =
        PlanTraverse(world->ground(), own.traverse, own.num_scans, drive_key);
    if (!stops.ok()) return stops.status();
    if (own.world.clear_drive) world = ClearedAlong(*world, *stops, own.rover);
    for (int scan = 0; scan < options.num_scans; ++scan) {
      if (options.separate_worlds && scan != i) continue;
      const double yaw = options.random_yaw || options.separate_worlds ? yaws[static_cast<std::size_t>(scan)] : 0.0;
      const absl::StatusOr<RigidTransform> pose = PoseAt(*world, (*stops)[static_cast<std::size_t>(scan)], own, yaw);
      if (!pose.ok()) return pose.status();
      simulation.T_world_scan_.push_back(*pose);
    }
    simulation.worlds_.push_back(std::make_shared<const World>(*std::move(world)));
  }
  return simulation;
}

Scan Simulation::ScanAt(int index) const {
  const uint64_t key = SubKey(SubKey(options_.seed, kScanStream), static_cast<uint64_t>(index));
  return SimulateScan(world(index), T_world_scan(index), options_.scanner, key);
}

std::vector<std::pair<int, int>> Simulation::NegativePairs() const {
  std::vector<std::pair<int, int>> pairs;
  if (!options_.separate_worlds) return pairs;
  // Worlds of the same kind lie four apart: three partners of its own kind for each scan, and two of others.
  constexpr std::array<int, 5> kOffsets = {1, 2, 4, 8, 12};
  for (const int offset : kOffsets) {
    // Twice the offset at most: no pair comes up a second time the other way round.
    if (2 * offset >= num_scans()) continue;
    for (int i = 0; i < num_scans(); ++i) pairs.emplace_back(i, (i + offset) % num_scans());
  }
  return pairs;
}

}  // namespace curvereg::sim
