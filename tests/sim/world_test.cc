// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/dome_world.h"
#include "sim/random.h"
#include "sim/yard_world.h"

namespace curvereg::sim {
namespace {

World SmallYard(double relief = 1.0) {
  return MakeYardWorld({.length_m = 30.0, .width_m = 20.0, .undulation = {.amplitude_m = 2.0, .hurst = 0.8}}, relief,
                       3);
}

Ray RandomRay(const World& world, RandomStream& random) {
  Ray ray;
  ray.origin.x() = random.Uniform(-14.0, 14.0);
  ray.origin.y() = random.Uniform(-9.0, 9.0);
  ray.origin.z() = world.SurfaceHeight(ray.origin.x(), ray.origin.y()) + random.Uniform(0.3, 3.0);
  ray.direction = Eigen::Vector3d(random.Normal(), random.Normal(), random.Uniform(-1.0, 0.2)).normalized();
  return ray;
}

double SmallestRock(const World& world, const Ray& ray) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Rock& rock : world.rocks()) nearest = std::min(nearest, rock.Intersect(ray));
  return nearest;
}

// First point below the ground, by steps of 2 mm and bisection.
double MarchToGround(const HeightGrid& ground, const Ray& ray, double max_range) {
  const auto above = [&](double t) {
    const Eigen::Vector3d point = ray.origin + t * ray.direction;
    const double height = ground.HeightAt(point.x(), point.y());
    return std::isnan(height) || point.z() > height;
  };
  for (double t = 0.0; t < max_range; t += 0.002) {
    if (above(t)) continue;
    double low = t - 0.002;
    double high = t;
    for (int i = 0; i < 40; ++i) (above(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    return high;
  }
  return std::numeric_limits<double>::infinity();
}

TEST(WorldTest, RaysMeetTheGroundWhereMarchingDoes) {
  const World yard = SmallYard();
  const World ground_only(yard.ground(), {});
  RandomStream random(11);
  int num_hits = 0;
  for (int i = 0; i < 300; ++i) {
    const Ray ray = RandomRay(yard, random);
    const Hit hit = ground_only.CastRay(ray, 25.0);
    const double marched = MarchToGround(yard.ground(), ray, 25.0);
    if (std::isfinite(marched)) {
      EXPECT_NEAR(hit.range, marched, 1e-6) << "ray " << i;
      ++num_hits;
    } else {
      // Marching may step over a crest that the exact root grazes; what is hit must still be ground.
      const Eigen::Vector3d point = ray.origin + std::min(hit.range, 1e3) * ray.direction;
      EXPECT_TRUE(hit.surface == Surface::kNothing ||
                  std::abs(point.z() - yard.ground().HeightAt(point.x(), point.y())) < 1e-9);
    }
  }
  EXPECT_GT(num_hits, 150);
}

TEST(WorldTest, BlocksHideNoRockAndNoGround) {
  const World yard = SmallYard();
  RandomStream random(12);
  int num_rock_hits = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Ray ray = RandomRay(yard, random);
    const Hit hit = yard.CastRay(ray, 60.0);
    // The ray from the grid's inside, cut at the grid's edge.
    double edge = 60.0;
    for (int axis = 0; axis < 2; ++axis) {
      const double half = axis == 0 ? 15.0 : 10.0;
      const double speed = std::abs(ray.direction[axis]);
      const double room = ray.direction[axis] > 0.0 ? half - ray.origin[axis] : half + ray.origin[axis];
      edge = std::min(edge, room / speed);
    }
    const double ground = yard.ground().Intersect(ray, 0.0, edge);
    const double rock = SmallestRock(yard, ray);
    const double expected = std::min(ground, rock);
    // A rock at the edge may stand out over it; there the world ends at the ground's edge.
    if (rock <= ground && rock > edge - 1e-6) continue;
    EXPECT_EQ(hit.surface == Surface::kNothing, !std::isfinite(expected)) << i;
    if (std::isfinite(expected)) {
      EXPECT_NEAR(hit.range, expected, 1e-9) << i;
    }
    if (hit.surface == Surface::kRock) ++num_rock_hits;
  }
  EXPECT_GT(num_rock_hits, 500);
}

TEST(WorldTest, NormalsStandOnTheSurfaceAndFaceTheRay) {
  const World yard = SmallYard();
  RandomStream random(13);
  for (int i = 0; i < 2'000; ++i) {
    const Ray ray = RandomRay(yard, random);
    const Hit hit = yard.CastRay(ray, 60.0);
    if (hit.surface == Surface::kNothing) continue;
    EXPECT_NEAR(hit.normal.norm(), 1.0, 1e-9);
    EXPECT_LT(hit.normal.dot(ray.direction), 1e-9);
  }
}

TEST(WorldTest, LooksStraightDownAtTheSurfaceHeight) {
  const World yard = SmallYard();
  RandomStream random(14);
  int num_rocks = 0;
  for (int i = 0; i < 5'000; ++i) {
    const double x = random.Uniform(-15.0, 15.0);
    const double y = random.Uniform(-10.0, 10.0);
    const Hit hit = yard.CastRay({.origin = {x, y, 20.0}, .direction = -Eigen::Vector3d::UnitZ()}, 100.0);
    ASSERT_NE(hit.surface, Surface::kNothing);
    EXPECT_NEAR(20.0 - hit.range, yard.SurfaceHeight(x, y), 1e-9);
    if (hit.surface == Surface::kRock) ++num_rocks;
  }
  EXPECT_GT(num_rocks, 20);
  EXPECT_TRUE(std::isnan(yard.SurfaceHeight(15.1, 0.0)));
}

TEST(WorldTest, NothingBeyondTheEdgeAndThroughHoles) {
  HeightGrid grid = MakeHeightGrid(10.0, 10.0, 1.0);
  grid.heights(5, 5) = std::numeric_limits<float>::quiet_NaN();
  const World world(grid, {});
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  EXPECT_EQ(world.CastRay({.origin = {2.0, 2.0, 3.0}, .direction = down}, 10.0).surface, Surface::kGround);
  EXPECT_EQ(world.CastRay({.origin = {2.0, 2.0, 3.0}, .direction = down}, 2.9).surface, Surface::kNothing);
  EXPECT_EQ(world.CastRay({.origin = {0.2, 0.2, 3.0}, .direction = down}, 10.0).surface, Surface::kNothing);
  EXPECT_EQ(world.CastRay({.origin = {6.0, 0.0, 3.0}, .direction = down}, 10.0).surface, Surface::kNothing);
  // From outside of the ground onto it.
  const Ray slanted = {.origin = {-8.0, 3.0, 4.0}, .direction = Eigen::Vector3d(1.0, 0.0, -1.0).normalized()};
  EXPECT_NEAR(world.CastRay(slanted, 10.0).range, 4.0 * std::sqrt(2.0), 1e-9);
}

TEST(WorldTest, DomeEndsAtItsShell) {
  const World dome = MakeDomeWorld({}, 1.0, 5);
  const Ray up = {.origin = {3.0, -4.0, 2.0}, .direction = Eigen::Vector3d::UnitZ()};
  const Hit top = dome.CastRay(up, 80.0);
  EXPECT_EQ(top.surface, Surface::kShell);
  EXPECT_NEAR(top.range, std::sqrt(400.0 - 25.0) - 2.0, 1e-9);
  RandomStream random(15);
  for (int i = 0; i < 5'000; ++i) {
    const Ray ray = {.origin = {0.0, 0.0, 3.0},
                     .direction = Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized()};
    const Hit hit = dome.CastRay(ray, 80.0);
    ASSERT_NE(hit.surface, Surface::kNothing) << "a dome is closed";
    EXPECT_LT((ray.origin + hit.range * ray.direction).norm(), 20.0 + 1e-6);
    EXPECT_LT(hit.normal.dot(ray.direction), 1e-9);
  }
}

TEST(WorldTest, ReliefScalesGroundAndRocks) {
  const World full = SmallYard(1.0);
  const World flat = SmallYard(0.1);
  ASSERT_EQ(full.rocks().size(), flat.rocks().size());
  for (std::size_t i = 0; i < full.ground().heights.size(); i += 97) {
    EXPECT_NEAR(flat.ground().heights.pixels[i], 0.1F * full.ground().heights.pixels[i], 1e-6F);
  }
  for (std::size_t i = 0; i < full.rocks().size(); ++i) {
    EXPECT_NEAR(flat.rocks()[i].half_extent.z(), 0.1 * full.rocks()[i].half_extent.z(), 1e-9);
    EXPECT_NEAR(flat.rocks()[i].half_extent.x(), full.rocks()[i].half_extent.x(), 1e-9);
  }
}

TEST(WorldTest, ClearanceSeesTallRocksOnly) {
  HeightGrid grid = MakeHeightGrid(20.0, 20.0, 0.5);
  Rock rock;
  rock.centre = {3.0, 0.0, 0.0};  // a unit ball half sunk: 1 m tall
  const World world(grid, {rock});
  EXPECT_FALSE(world.IsClearOfRocks({5.0, 0.0}, 1.5, 0.25));
  EXPECT_TRUE(world.IsClearOfRocks({5.0, 0.0}, 0.9, 0.25));
  EXPECT_TRUE(world.IsClearOfRocks({5.0, 0.0}, 1.5, 1.1));
}

}  // namespace
}  // namespace curvereg::sim
