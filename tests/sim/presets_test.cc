// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/presets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

#include "sim/simulation.h"
#include "tests/testing/test_data.h"

namespace curvereg::sim {
namespace {

Simulation Make(std::string_view name, uint64_t seed = 1) {
  SimulationOptions options = PresetOptions(name).value();
  options.seed = seed;
  absl::StatusOr<Simulation> simulation = Simulation::Create(options);
  EXPECT_TRUE(simulation.ok()) << simulation.status();
  return *std::move(simulation);
}

// Mean distance and rotation from each scan to the one `every` later.
TransformDifference MeanStep(const Simulation& simulation, int every) {
  TransformDifference mean;
  const int count = simulation.num_scans() - every;
  for (int i = 0; i < count; ++i) {
    const TransformDifference step = Difference(simulation.T_world_scan(i), simulation.T_world_scan(i + every));
    mean.translation_m += step.translation_m / count;
    mean.rotation_rad += step.rotation_rad / count;
  }
  return mean;
}

TEST(PresetsTest, AllHaveOptionsButUnknownNames) {
  for (const Preset& preset : Presets()) {
    const std::optional<SimulationOptions> options = PresetOptions(preset.name);
    ASSERT_TRUE(options.has_value()) << preset.name;
    EXPECT_TRUE(Validate(*options).ok()) << preset.name;
  }
  EXPECT_FALSE(PresetOptions("mars-yard").has_value());
}

TEST(PresetsTest, MarsYardSimHasThePapersFigures) {
  for (const uint64_t seed : {1, 2, 3}) {
    const Simulation simulation = Make("mars-yard-sim", seed);
    ASSERT_EQ(simulation.num_scans(), 40);
    const TransformDifference step = MeanStep(simulation, 1);
    EXPECT_NEAR(step.translation_m, 5.4, 0.03 * 5.4);
    EXPECT_NEAR(step.rotation_rad, 0.1, 0.015);
  }
  const Simulation simulation = Make("mars-yard-sim");
  EXPECT_EQ(simulation.options().scanner.pattern.num_beams(), 720 * 361);
  double num_points = 0.0;
  for (int i = 0; i < 40; i += 4) num_points += static_cast<double>(simulation.ScanAt(i).points.size()) / 10.0;
  EXPECT_NEAR(num_points, 224e3, 6e3);
  const HeightGrid& ground = simulation.world(0).ground();
  EXPECT_DOUBLE_EQ(ground.x_max() - ground.x_min, 120.0);
  EXPECT_DOUBLE_EQ(ground.y_max() - ground.y_min, 60.0);
}

TEST(PresetsTest, MarsDomeHasThePapersFigures) {
  for (const uint64_t seed : {1, 2, 3}) {
    const Simulation simulation = Make("mars-dome", seed);
    ASSERT_EQ(simulation.num_scans(), 95);
    const TransformDifference step = MeanStep(simulation, 5);
    EXPECT_NEAR(step.translation_m, 2.38, 0.03 * 2.38);
    EXPECT_NEAR(step.rotation_rad, 0.45, 0.05 * 0.45);
  }
}

TEST(PresetsTest, MarsYardRealIsAMillionBeamsThinnedToAQuarter) {
  const Simulation simulation = Make("mars-yard-real");
  ASSERT_EQ(simulation.num_scans(), 17);
  EXPECT_NEAR(simulation.options().scanner.pattern.num_beams(), 1e6, 1e4);
  EXPECT_NEAR(MeanStep(simulation, 1).translation_m, 15.0, 0.5);
  const auto num_points = static_cast<double>(simulation.ScanAt(8).points.size());
  EXPECT_GT(num_points, 170e3);
  EXPECT_LT(num_points, 250e3);
}

TEST(PresetsTest, RandomYawTurnsTheSensorAnyhow) {
  const Simulation straight = Make("mars-yard-sim");
  for (const uint64_t seed : {1, 2, 3}) {
    const Simulation simulation = Make("random-yaw", seed);
    EXPECT_NEAR(MeanStep(simulation, 1).rotation_rad, 1.6, 0.2);
    EXPECT_NEAR(MeanStep(simulation, 2).rotation_rad, 1.6, 0.3);
  }
  const Simulation simulation = Make("random-yaw");
  for (int i = 0; i < 40; ++i) {
    EXPECT_LT(Difference(straight.T_world_scan(i), simulation.T_world_scan(i)).translation_m, 1e-9) << "same places";
  }
}

TEST(PresetsTest, SparseAndOutliersKeepAQuarter) {
  const auto full = static_cast<double>(Make("mars-yard-sim").ScanAt(20).points.size());
  EXPECT_NEAR(static_cast<double>(Make("sparse").ScanAt(20).points.size()) / full, 0.25, 0.005);
  EXPECT_NEAR(static_cast<double>(Make("outliers").ScanAt(20).points.size()) / full, 0.25, 0.005);
  EXPECT_EQ(PresetOptions("outliers")->scanner.outlier_fraction, 0.15);
}

TEST(PresetsTest, FlatIsTheYardAtATenth) {
  const Simulation yard = Make("mars-yard-sim");
  const Simulation flat = Make("flat");
  const auto& heights = yard.world(0).ground().heights;
  for (std::size_t i = 0; i < heights.size(); i += 1009) {
    EXPECT_NEAR(flat.world(0).ground().heights.pixels[i], 0.1F * heights.pixels[i], 1e-6F);
  }
}

TEST(PresetsTest, NegativePairsShareNothing) {
  const Simulation simulation = Make("negatives");
  ASSERT_EQ(simulation.num_scans(), 40);
  const std::vector<std::pair<int, int>> pairs = simulation.NegativePairs();
  EXPECT_EQ(pairs.size(), 200U);
  std::set<std::pair<int, int>> distinct;
  for (const auto& [source, target] : pairs) {
    ASSERT_NE(source, target);
    distinct.insert(std::minmax(source, target));
    EXPECT_NE(&simulation.world(source), &simulation.world(target));
  }
  EXPECT_EQ(distinct.size(), 200U);
  // Also worlds of the same kind are different ground.
  const auto& first = simulation.world(0).ground().heights;
  const auto& fifth = simulation.world(4).ground().heights;
  ASSERT_EQ(first.size(), fifth.size());
  EXPECT_NE(first.pixels, fifth.pixels);
  EXPECT_TRUE(simulation.world(2).shell().has_value());
}

TEST(PresetsTest, GaleDrivesOverTheRealModel) {
  const auto folder = testing::RealDataPath("terrain");
  if (!folder.has_value()) GTEST_SKIP() << "no real elevation models on this machine";
  SimulationOptions options = *PresetOptions("gale");
  options.world.elevation.path = *folder + "/mars_gale_hirise_1m.asc";
  const absl::StatusOr<Simulation> simulation = Simulation::Create(options);
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_NEAR(MeanStep(*simulation, 1).translation_m, 8.0, 0.4);
  EXPECT_GT(simulation->ScanAt(3).points.size(), 150'000U);
}

}  // namespace
}  // namespace curvereg::sim
