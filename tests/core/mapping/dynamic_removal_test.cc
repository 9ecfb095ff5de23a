// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/dynamic_removal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include "tests/core/mapping/map_scenes.h"

namespace curvereg {
namespace {

using testing::MapScene;

// Range at which the ray meets the box, if it does.
std::optional<double> RangeOfBox(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& origin,
                                 const Eigen::Vector3d& direction) {
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    double near = (box.min()[axis] - origin[axis]) / direction[axis];
    double far = (box.max()[axis] - origin[axis]) / direction[axis];
    if (near > far) std::swap(near, far);
    enter = std::max(enter, near);
    leave = std::min(leave, far);
  }
  return enter > 0.0 && enter < leave ? std::optional(enter) : std::nullopt;
}

// A box of 1.2 x 1 x 1.2 m, its foot in the ground at (x, y).
Eigen::AlignedBox3d BoxAt(double x, double y) {
  const Eigen::Vector3d centre(x, y, testing::BumpyHeight(x, y) + 0.5);
  const Eigen::Vector3d half(0.6, 0.5, 0.7);
  return {centre - half, centre + half};
}

constexpr int kNumScans = 8;
constexpr int kNumColumns = 720;

RigidTransform PoseOf(int i) { return testing::RoverPose(1.5 * i - 5.0, 0.3 * std::sin(1.0 * i), 0.3 * i); }

// Bumpy ground scanned by a rover that drives 1.5 m between scans; made once.
const std::vector<Scan>& GroundScans() {
  static const std::vector<Scan> scans = [] {
    std::vector<Scan> made;
    for (int i = 0; i < kNumScans; ++i) {
      made.push_back(testing::BumpyGround(
          PoseOf(i), {.num_columns = kNumColumns, .num_rows = 72, .noise_seed = static_cast<uint64_t>(i) + 1}));
    }
    return made;
  }();
  return scans;
}

// The same with a box in some scans.
struct BoxScene {
  MapScene with_box;
  MapScene boxes;   // its points alone
  MapScene ground;  // all others alone
};

// `box_of(i)`: where it is at scan i.
template <typename BoxOf>
BoxScene DriveBy(int num_scans, const BoxOf& box_of) {
  BoxScene scene;
  for (int i = 0; i < num_scans; ++i) {
    const RigidTransform T = PoseOf(i);
    Scan scan = GroundScans()[static_cast<std::size_t>(i)];
    Scan box_points, ground_points;
    const std::optional<Eigen::AlignedBox3d> box = box_of(i);
    for (Eigen::Vector3f& point : scan.points) {
      const Eigen::Vector3d direction = T.linear() * point.cast<double>().normalized();
      const std::optional<double> range = box ? RangeOfBox(*box, T.translation(), direction) : std::nullopt;
      const bool is_box = range && *range < static_cast<double>(point.norm());
      if (is_box) point *= static_cast<float>(*range) / point.norm();
      (is_box ? box_points : ground_points).points.push_back(point);
    }
    scene.with_box.Add(std::move(scan), T);
    scene.boxes.Add(std::move(box_points), T);
    scene.ground.Add(std::move(ground_points), T);
  }
  return scene;
}

using CellSet = std::set<std::tuple<int, int, int>>;
CellSet SetOf(const MapScene& scene, bool remove_dynamic) {
  CellSet set;
  for (const MapCell& cell : testing::CellsOf(scene, {.cell_m = 0.1, .remove_dynamic = remove_dynamic})) {
    set.emplace(cell.index.x(), cell.index.y(), cell.index.z());
  }
  return set;
}

// Shares of cells that the map keeps.
struct Kept {
  double box = 0.0;       // cells with points of the box alone, 0.25 m and more above the ground
  double box_foot = 0.0;  // those below
  double ground = 0.0;    // cells without points of the box
  int num_box_cells = 0;
};
double Share(int part, int all) { return all == 0 ? 0.0 : static_cast<double>(part) / all; }

Kept ShareKept(const BoxScene& scene) {
  const CellSet kept = SetOf(scene.with_box, true);
  const CellSet ground = SetOf(scene.ground, false);
  int num_boxes = 0, num_boxes_kept = 0, num_feet = 0, num_feet_kept = 0, num_ground_kept = 0;
  for (const auto& cell : SetOf(scene.boxes, false)) {
    if (ground.contains(cell)) continue;
    const auto [x, y, z] = cell;
    const bool is_foot = 0.1 * z < testing::BumpyHeight(0.1 * x + 0.05, 0.1 * y + 0.05) + 0.25;
    ++(is_foot ? num_feet : num_boxes);
    if (kept.contains(cell)) ++(is_foot ? num_feet_kept : num_boxes_kept);
  }
  for (const auto& cell : ground) num_ground_kept += kept.contains(cell);
  const Kept shares{Share(num_boxes_kept, num_boxes), Share(num_feet_kept, num_feet),
                    Share(num_ground_kept, static_cast<int>(ground.size())), num_boxes};
  for (const auto& [name, share] :
       {std::pair("box", shares.box), std::pair("box_foot", shares.box_foot), std::pair("ground", shares.ground)}) {
    ::testing::Test::RecordProperty(std::string(name) + "_kept", std::to_string(share));
  }
  return shares;
}

TEST(DynamicRemovalTest, AMovingBoxGoesAndTheGroundStays) {
  // It drives along beside the rover, now and then out of sight.
  const Kept kept = ShareKept(DriveBy(
      kNumScans, [](int i) { return i % 3 == 2 ? std::nullopt : std::optional(BoxAt(1.5 * i - 3.0, 5.0 - 0.4 * i)); }));
  EXPECT_GT(kept.num_box_cells, 500);
  EXPECT_LT(kept.box, 0.02);
  EXPECT_LT(kept.box_foot, 0.65) << "beams near the ground tell less";
  EXPECT_GT(kept.ground, 0.995);
}

TEST(DynamicRemovalTest, ABoxThatStaysIsKept) {
  const Kept kept = ShareKept(DriveBy(kNumScans, [](int) { return std::optional(BoxAt(1.0, 5.0)); }));
  EXPECT_GT(kept.num_box_cells, 150);
  EXPECT_GT(kept.box, 0.98);
  EXPECT_GT(kept.ground, 0.995);
}

TEST(DynamicRemovalTest, OneScanAloneLosesNothing) {
  const Kept kept = ShareKept(DriveBy(1, [](int) { return std::optional(BoxAt(-2.0, 2.0)); }));
  EXPECT_GT(kept.num_box_cells, 50);
  EXPECT_EQ(kept.box, 1.0);
  EXPECT_EQ(kept.ground, 1.0);
}

// One cell 5 m ahead of sensors that see a wall there, or one 10 m ahead, or nothing.
class OneCellTest : public ::testing::Test {
 protected:
  OneCellTest() {
    PlacedPoint placed;
    EXPECT_TRUE(grid_.Place({5.0, 0.02, 0.02}, &placed));
    cells_.push_back({placed.key, placed.offset, 1});
  }
  static Scan Wall(double range_m) {
    Scan scan;
    for (int row = -60; row <= 60; ++row) {
      for (int column = -60; column <= 60; ++column) {
        scan.points.push_back(Eigen::Vector3d(range_m, 0.01 * range_m * column, 0.01 * range_m * row).cast<float>());
      }
    }
    return scan;
  }
  bool IsDynamic(int num_through, int num_surface) const {
    FreeSpaceVotes votes(cells_, grid_);
    for (int i = 0; i < num_through; ++i) votes.AddScan(Wall(10.0), RigidTransform::Identity());
    for (int i = 0; i < num_surface; ++i) votes.AddScan(Wall(5.0), RigidTransform::Identity());
    votes.AddScan(Wall(2.0), RigidTransform::Identity());  // sees nothing of it
    return votes.IsDynamic(0);
  }

  CellGrid grid_{0.1, Eigen::Vector3d::Zero()};
  std::vector<CellSum> cells_;
};

TEST_F(OneCellTest, ClearlyMoreMustSeeFreeSpaceThere) {
  EXPECT_FALSE(IsDynamic(0, 0));
  EXPECT_FALSE(IsDynamic(0, 3));
  EXPECT_TRUE(IsDynamic(1, 0));
  EXPECT_TRUE(IsDynamic(1, 1));
  EXPECT_FALSE(IsDynamic(2, 2));
  EXPECT_TRUE(IsDynamic(3, 2));
  EXPECT_FALSE(IsDynamic(8, 5));
  EXPECT_TRUE(IsDynamic(9, 5));
}

TEST_F(OneCellTest, OnlyScansNearEnoughHaveAVote) {
  const FreeSpaceVotes votes(cells_, grid_);
  EXPECT_TRUE(votes.HasVote(RigidTransform::Identity()));
  EXPECT_TRUE(votes.HasVote(testing::UprightPose(-24.0, 0.0, 0.0)));
  EXPECT_FALSE(votes.HasVote(testing::UprightPose(-28.0, 0.0, 0.0)));
  FreeSpaceVotes far(cells_, grid_);
  far.AddScan(Wall(80.0), testing::UprightPose(-26.0, 0.0, 0.0, 0.0));
  EXPECT_FALSE(far.IsDynamic(0));
  FreeSpaceVotes near(cells_, grid_);
  near.AddScan(Wall(80.0), testing::UprightPose(-20.0, 0.0, 0.0, 0.0));
  EXPECT_TRUE(near.IsDynamic(0));
  EXPECT_FALSE(FreeSpaceVotes({}, grid_).HasVote(RigidTransform::Identity()));
}

}  // namespace
}  // namespace curvereg
