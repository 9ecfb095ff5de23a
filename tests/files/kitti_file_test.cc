// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/kitti_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/testing/corrupt_files.h"

namespace curvereg {
namespace {

using testing::Bytes;

absl::StatusOr<Scan> Parse(std::string_view bytes) { return ParseKitti(bytes, {}); }

std::string Point(float x, float y, float z) { return Bytes(x) + Bytes(y) + Bytes(z) + Bytes(0.5F); }

TEST(KittiFileTest, ReadsPointsWithoutReflectance) {
  const absl::StatusOr<Scan> scan = testing::ParseExact(Parse, Point(1, -2, 3.5F) + Point(0, 120, -0.25F));
  ASSERT_TRUE(scan.ok()) << scan.status();
  EXPECT_THAT(scan->points, ::testing::ElementsAre(Eigen::Vector3f(1, -2, 3.5F), Eigen::Vector3f(0, 120, -0.25F)));
}

TEST(KittiFileTest, KeepsPointsThatAreNotFinite) {
  const absl::StatusOr<Scan> scan =
      Parse(Point(std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1));
  ASSERT_TRUE(scan.ok()) << scan.status();
  EXPECT_TRUE(std::isnan(scan->points[0].x()));
  EXPECT_TRUE(std::isinf(scan->points[0].y()));
}

TEST(KittiFileTest, RefusesPartsOfPoints) {
  const std::string bytes = Point(1, 2, 3) + Point(4, 5, 6);
  for (std::size_t length = 1; length < bytes.size(); ++length) {
    if (length == 16) continue;  // a whole point: nothing tells that there was another
    EXPECT_TRUE(absl::IsDataLoss(testing::ParseExact(Parse, bytes.substr(0, length)).status())) << length;
  }
}

TEST(KittiFileTest, RefusesBytesThatAreNoCoordinates) {
  std::string noise;
  uint32_t state = 1;
  for (int i = 0; i < 1600; ++i) {
    state = state * 1664525U + 1013904223U;
    noise += static_cast<char>(state >> 24);
  }
  EXPECT_TRUE(absl::IsInvalidArgument(Parse(noise).status()));
}

TEST(KittiFileTest, SurvivesEveryCorruptByte) {
  testing::ExpectCorruptionsSurvived(Parse, Point(1, 2, 3) + Point(4, 5, 6) + Point(7, 8, 9), 3);
}

TEST(KittiFileTest, RefusesMorePointsThanTheLimit) {
  CloudReadOptions options;
  options.max_points = 1;
  EXPECT_TRUE(absl::IsResourceExhausted(ParseKitti(Point(1, 2, 3) + Point(4, 5, 6), options).status()));
}

}  // namespace
}  // namespace curvereg
