// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/cube_map.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

TEST(CubeMapTest, FacesHoldOneAxisDirectionEach) {
  const CubeMap cube{.side = 5};
  EXPECT_EQ(cube.num_bins(), 150);
  std::set<int> faces;
  for (const float sign : {1.0F, -1.0F}) {
    for (int axis = 0; axis < 3; ++axis) {
      const int bin = cube.BinOf(sign * Eigen::Vector3f::Unit(axis));
      EXPECT_EQ(bin % 25, 12) << "the middle of a face";
      faces.insert(bin / 25);
    }
  }
  EXPECT_EQ(faces.size(), 6U);
}

TEST(CubeMapTest, OnlyTheDirectionCounts) {
  const CubeMap cube{.side = 90};
  testing::Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3f direction(static_cast<float>(random.Gaussian()), static_cast<float>(random.Gaussian()),
                                    static_cast<float>(random.Gaussian()));
    const int bin = cube.BinOf(direction);
    EXPECT_GE(bin, 0);
    EXPECT_LT(bin, cube.num_bins());
    EXPECT_EQ(cube.BinOf(64.0F * direction), bin);
    EXPECT_EQ(cube.BinOf(0.125F * direction), bin);
  }
}

TEST(CubeMapTest, DirectionsOfOneBinAreNear) {
  const CubeMap cube{.side = 20};
  testing::Random random(4);
  std::vector<Eigen::Vector3f> first(static_cast<size_t>(cube.num_bins()), Eigen::Vector3f::Zero());
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3f direction =
        Eigen::Vector3f(static_cast<float>(random.Gaussian()), static_cast<float>(random.Gaussian()),
                        static_cast<float>(random.Gaussian()))
            .normalized();
    Eigen::Vector3f& other = first[static_cast<size_t>(cube.BinOf(direction))];
    if (other.isZero()) other = direction;
    EXPECT_LT((direction - other).norm(), std::sqrt(2.0F) * 2.0F / 20.0F);  // the diagonal of the widest bin
  }
}

TEST(CubeMapTest, NeighboursStayOnTheFace) {
  const CubeMap cube{.side = 4};
  for (int bin = 0; bin < cube.num_bins(); ++bin) {
    const int row = bin % 16 / 4, col = bin % 4;
    std::set<int> neighbours;
    cube.ForNeighbours(bin, [&](int other) {
      EXPECT_EQ(other / 16, bin / 16);
      EXPECT_LE(std::abs(other % 16 / 4 - row), 1);
      EXPECT_LE(std::abs(other % 4 - col), 1);
      neighbours.insert(other);
    });
    const auto along = [](int position) { return position == 0 || position == 3 ? 2U : 3U; };
    EXPECT_EQ(neighbours.size(), along(row) * along(col));
    EXPECT_EQ(neighbours.count(bin), 1U);
  }
}

}  // namespace
}  // namespace curvereg
