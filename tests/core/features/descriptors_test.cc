// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/descriptors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalfBin = 0.0873;  // of the 36 bins that directions are counted in [rad]
constexpr int kSize = 81;
constexpr Keypoint kCentre{.row = 40.0F, .col = 40.0F, .level = 0, .response = 1.0F};

// A ramp that rises along `angle_rad`, counted from +col towards +row.
Image<float> Ramp(double angle_rad) {
  Image<float> image(kSize, kSize);
  for (int row = 0; row < kSize; ++row) {
    for (int col = 0; col < kSize; ++col) {
      image(row, col) = static_cast<float>(0.1 * (std::cos(angle_rad) * col + std::sin(angle_rad) * row));
    }
  }
  return image;
}

// Waves with a preferred direction, without symmetry.
Image<float> Texture(uint64_t seed) {
  testing::Random random(seed);
  Image<float> image(kSize, kSize);
  for (int wave = 0; wave < 8; ++wave) {
    const double k_row = random.Uniform(-0.5, 0.5), k_col = random.Uniform(-0.5, 0.5), phase = random.Uniform(0, 6.28);
    for (int row = 0; row < kSize; ++row) {
      for (int col = 0; col < kSize; ++col) {
        image(row, col) += static_cast<float>(std::sin(k_row * row + k_col * col + phase));
      }
    }
  }
  return image;
}

// By a quarter turn from +col to +row about the centre.
Image<float> QuarterTurned(const Image<float>& image) {
  Image<float> turned(kSize, kSize);
  for (int row = 0; row < kSize; ++row) {
    for (int col = 0; col < kSize; ++col) turned(col, kSize - 1 - row) = image(row, col);
  }
  return turned;
}

double Distance(const float* a, const float* b) {
  double squared = 0.0;
  for (int i = 0; i < kDescriptorSize; ++i) squared += std::pow(a[i] - b[i], 2);
  return std::sqrt(squared);
}

double Length(const float* a) {
  const std::vector<float> zero(kDescriptorSize);
  return Distance(a, zero.data());
}

double AngleError(double a, double b) { return std::abs(std::remainder(a - b, 2.0 * kPi)); }

std::vector<Keypoint> Grid() {
  std::vector<Keypoint> keypoints;
  for (int row = 0; row < kSize; row += 8) {
    for (int col = 0; col < kSize; col += 8) {
      keypoints.push_back({static_cast<float>(row), static_cast<float>(col), 0, 1.0F});
    }
  }
  return keypoints;
}

TEST(DescribeKeypointsTest, OrientationIsTheDirectionOfTheSlope) {
  for (const double angle : {0.0, 0.5, 1.5, 3.0, -0.7, -2.5}) {
    const Features features = DescribeKeypoints({Ramp(angle)}, {kCentre});
    ASSERT_EQ(features.size(), 1U);
    EXPECT_LT(AngleError(features.orientations_rad[0], angle), kHalfBin) << angle;
    EXPECT_GE(features.orientations_rad[0], -kPi);
    EXPECT_LT(features.orientations_rad[0], kPi);
  }
}

TEST(DescribeKeypointsTest, UnitLengthAlsoAtTheBorder) {
  const auto keypoints = Grid();
  const Features features = DescribeKeypoints({Texture(1)}, keypoints);
  EXPECT_GE(features.size(), keypoints.size());
  ASSERT_EQ(features.orientations_rad.size(), features.size());
  ASSERT_EQ(features.descriptors.size(), features.size() * kDescriptorSize);
  for (size_t i = 0; i < features.size(); ++i) {
    EXPECT_NEAR(Length(features.Descriptor(i)), 1.0, 1e-5);
    EXPECT_GE(*std::min_element(features.Descriptor(i), features.Descriptor(i) + kDescriptorSize), 0.0F);
    EXPECT_GE(features.orientations_rad[i], -kPi);
    EXPECT_LT(features.orientations_rad[i], kPi);
  }
}

TEST(DescribeKeypointsTest, OrderFollowsTheKeyPointsAndSecondDirectionsFollowTheFirst) {
  const auto keypoints = Grid();
  const Features features = DescribeKeypoints({Texture(2)}, keypoints);
  size_t i = 0;
  size_t num_second = 0;
  for (const Keypoint& keypoint : keypoints) {
    ASSERT_LT(i, features.size());
    EXPECT_EQ(features.keypoints[i].row, keypoint.row);
    EXPECT_EQ(features.keypoints[i].col, keypoint.col);
    ++i;
    if (i < features.size() && features.keypoints[i].row == keypoint.row && features.keypoints[i].col == keypoint.col) {
      EXPECT_GT(AngleError(features.orientations_rad[i], features.orientations_rad[i - 1]), 0.1);
      ++i;
      ++num_second;
    }
  }
  EXPECT_EQ(i, features.size());
  EXPECT_GT(num_second, 0U);
  EXPECT_EQ(DescribeKeypoints({Texture(2)}, keypoints, {.max_orientations = 1}).size(), keypoints.size());
}

TEST(DescribeKeypointsTest, QuarterTurnsKeepDescriptorsAndTurnOrientations) {
  Image<float> image = Texture(3);
  const Features expected = DescribeKeypoints({image}, {kCentre});
  ASSERT_GE(expected.size(), 1U);
  for (int quarter = 1; quarter < 4; ++quarter) {
    image = QuarterTurned(image);
    const Features features = DescribeKeypoints({image}, {kCentre});
    ASSERT_EQ(features.size(), expected.size());
    for (size_t i = 0; i < features.size(); ++i) {
      EXPECT_LT(AngleError(features.orientations_rad[i], expected.orientations_rad[i] + quarter * kPi / 2), 0.01);
      EXPECT_LT(Distance(features.Descriptor(i), expected.Descriptor(i)), 0.1);
    }
  }
  // Far less than between different places.
  const Features other = DescribeKeypoints({Texture(4)}, {kCentre});
  EXPECT_GT(Distance(other.Descriptor(0), expected.Descriptor(0)), 0.5);
}

TEST(DescribeKeypointsTest, HeightAndContrastDoNotMatter) {
  const Image<float> image = Texture(5);
  Image<float> changed = image;
  for (float& pixel : changed.pixels) pixel = 3.0F * pixel + 20.0F;
  const Features expected = DescribeKeypoints({image}, {kCentre});
  const Features features = DescribeKeypoints({changed}, {kCentre});
  ASSERT_EQ(features.size(), expected.size());
  EXPECT_LT(Distance(features.Descriptor(0), expected.Descriptor(0)), 1e-3);
}

TEST(DescribeKeypointsTest, WithoutOrientationTheWindowStaysAligned) {
  const Image<float> image = Texture(6);
  const DescriptorOptions aligned{.step_px = 1.0, .oriented = false};
  const Features features = DescribeKeypoints({image}, {kCentre}, aligned);
  ASSERT_EQ(features.size(), 1U);
  EXPECT_EQ(features.orientations_rad[0], 0.0F);
  EXPECT_NEAR(Length(features.Descriptor(0)), 1.0, 1e-5);
  const Features turned = DescribeKeypoints({QuarterTurned(image)}, {kCentre}, aligned);
  EXPECT_GT(Distance(turned.Descriptor(0), features.Descriptor(0)), 0.3);
}

TEST(DescribeKeypointsTest, UsesTheImageOfTheKeyPointsLevel) {
  Keypoint second = kCentre;
  second.level = 1;
  const Features features = DescribeKeypoints({Ramp(0.5), Ramp(-2.0)}, {kCentre, second});
  ASSERT_EQ(features.size(), 2U);
  EXPECT_LT(AngleError(features.orientations_rad[0], 0.5), kHalfBin);
  EXPECT_LT(AngleError(features.orientations_rad[1], -2.0), kHalfBin);
}

TEST(DescribeKeypointsTest, NoGradientNoFeature) {
  const Image<float> flat(kSize, kSize, 2.0F);
  EXPECT_EQ(DescribeKeypoints({flat}, {kCentre}).size(), 0U);
  EXPECT_EQ(DescribeKeypoints({flat}, {kCentre}, {.oriented = false}).size(), 0U);
}

TEST(DescribeKeypointsTest, EmptyInputGivesNoFeatures) {
  EXPECT_EQ(DescribeKeypoints({}, {}).size(), 0U);
  EXPECT_EQ(DescribeKeypoints({Texture(1)}, {}).size(), 0U);
}

TEST(DescribeKeypointsTest, SameBytesAtAnyThreadCount) {
  const std::vector<Image<float>> images = {Texture(1), Texture(2)};
  auto keypoints = Grid();
  for (size_t i = 0; i < keypoints.size(); i += 2) keypoints[i].level = 1;
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    const Features features = DescribeKeypoints(images, keypoints);
    log.Add(features.orientations_rad);
    log.Add(features.descriptors);
  });
}

}  // namespace
}  // namespace curvereg
