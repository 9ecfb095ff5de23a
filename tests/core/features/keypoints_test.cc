// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/keypoints.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "core/curvelet/scale_bands.h"
#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

struct Blob {
  double row, col, height;
};

// Gaussian blobs of standard deviation `sigma_px`.
Image<float> Blobs(int size, double sigma_px, const std::vector<Blob>& blobs) {
  Image<float> image(size, size);
  for (int row = 0; row < size; ++row) {
    for (int col = 0; col < size; ++col) {
      for (const Blob& blob : blobs) {
        const double squared = std::pow(row - blob.row, 2) + std::pow(col - blob.col, 2);
        image(row, col) += static_cast<float>(blob.height * std::exp(-0.5 * squared / (sigma_px * sigma_px)));
      }
    }
  }
  return image;
}

// A stack of three levels with the image in the middle: extrema of the image are extrema of the stack.
std::vector<Image<float>> MiddleOfThree(const Image<float>& image) {
  return {Image<float>(image.rows, image.cols), image, Image<float>(image.rows, image.cols)};
}

Image<float> AllValid(const Image<float>& image) { return Image<float>(image.rows, image.cols, 1.0F); }

Image<float> SmoothNoise(int size, uint64_t seed) {
  testing::Random random(seed);
  std::vector<Blob> blobs;
  for (int i = 0; i < 120; ++i) {
    blobs.push_back({random.Uniform(0.0, size), random.Uniform(0.0, size), random.Gaussian()});
  }
  return Blobs(size, 2.5, blobs);
}

TEST(DifferenceOfCurveletsTest, SubtractsTheCoarserBand) {
  const std::vector<Image<float>> bands = {Image<float>(2, 3, 1.0F), Image<float>(2, 3, 5.0F),
                                           Image<float>(2, 3, -2.0F)};
  const auto stack = DifferenceOfCurvelets(bands);
  ASSERT_EQ(stack.size(), 3U);
  EXPECT_EQ(stack[0].pixels, bands[0].pixels);
  EXPECT_EQ(stack[1].pixels, std::vector<float>(6, 4.0F));
  EXPECT_EQ(stack[2].pixels, std::vector<float>(6, -7.0F));
  EXPECT_TRUE(DifferenceOfCurvelets({}).empty());
}

TEST(DetectKeypointsTest, FindsBlobsToAFractionOfAPixel) {
  const Image<float> image = Blobs(64, 3.0, {{20.3, 40.8, 1.0}, {44.6, 17.1, -0.5}});
  const auto keypoints = DetectKeypoints(MiddleOfThree(image), AllValid(image));
  ASSERT_EQ(keypoints.size(), 2U);
  EXPECT_NEAR(keypoints[0].row, 20.3, 0.05);
  EXPECT_NEAR(keypoints[0].col, 40.8, 0.05);
  EXPECT_NEAR(keypoints[0].response, 1.0, 0.03);
  EXPECT_EQ(keypoints[0].level, 1);
  EXPECT_NEAR(keypoints[1].row, 44.6, 0.05);
  EXPECT_NEAR(keypoints[1].col, 17.1, 0.05);
  EXPECT_NEAR(keypoints[1].response, -0.5, 0.03);
}

TEST(DetectKeypointsTest, MustExceedTheLevelsBeside) {
  const Image<float> image = Blobs(64, 3.0, {{32.0, 32.0, 1.0}});
  for (const size_t beside : {0U, 2U}) {
    auto stack = MiddleOfThree(image);
    stack[beside](33, 31) = 1.0F;  // equal is not exceeded
    EXPECT_TRUE(DetectKeypoints(stack, AllValid(image)).empty());
    stack[beside](33, 31) = 0.999F;
    EXPECT_EQ(DetectKeypoints(stack, AllValid(image)).size(), 1U);
  }
}

TEST(DetectKeypointsTest, ThresholdsRejectWeakInterpolatedAndBorderPoints) {
  const Image<float> image = Blobs(64, 3.0, {{32.0, 32.0, 0.02}, {7.0, 30.0, 0.02}});
  const auto stack = MiddleOfThree(image);
  EXPECT_EQ(DetectKeypoints(stack, AllValid(image)).size(), 1U);
  EXPECT_EQ(DetectKeypoints(stack, AllValid(image), {.border_px = 6}).size(), 2U);
  EXPECT_TRUE(DetectKeypoints(stack, AllValid(image), {.min_response = 0.021}).empty());
  Image<float> share = AllValid(image);
  share(32, 32) = 0.39F;
  EXPECT_TRUE(DetectKeypoints(stack, share).empty());
  EXPECT_EQ(DetectKeypoints(stack, share, {.min_valid_fraction = 0.3}).size(), 1U);
}

TEST(DetectKeypointsTest, StrongestFirstAndAtMostSoMany) {
  const Image<float> image =
      Blobs(96, 3.0, {{20.0, 20.0, 0.5}, {20.0, 70.0, -0.9}, {70.0, 20.0, 0.7}, {70.0, 70.0, -0.5}});
  const auto keypoints = DetectKeypoints(MiddleOfThree(image), AllValid(image));
  ASSERT_EQ(keypoints.size(), 4U);
  EXPECT_LT(keypoints[0].response, -0.8F);
  EXPECT_GT(keypoints[1].response, 0.6F);
  EXPECT_EQ(keypoints[2].row, 20.0F);  // a tie: image order
  EXPECT_EQ(keypoints[3].row, 70.0F);
  const auto strongest = DetectKeypoints(MiddleOfThree(image), AllValid(image), {.max_per_level = 2});
  ASSERT_EQ(strongest.size(), 2U);
  EXPECT_EQ(strongest[0].response, keypoints[0].response);
  EXPECT_EQ(strongest[1].response, keypoints[1].response);
}

TEST(DetectKeypointsTest, LevelsInOrderAndOnlyThoseAsked) {
  const Image<float> zero(64, 64);
  std::vector<Image<float>> stack = {zero, Blobs(64, 3.0, {{20.0, 20.0, 0.5}}), zero,
                                     Blobs(64, 3.0, {{40.0, 40.0, 0.9}}), zero};
  const auto keypoints = DetectKeypoints(stack, AllValid(zero));
  ASSERT_EQ(keypoints.size(), 2U);
  EXPECT_EQ(keypoints[0].level, 1);
  EXPECT_EQ(keypoints[1].level, 3);
  const auto later = DetectKeypoints(stack, AllValid(zero), {.first_level = 2});
  ASSERT_EQ(later.size(), 1U);
  EXPECT_EQ(later[0].level, 3);
  EXPECT_EQ(DetectKeypoints(stack, AllValid(zero), {.last_level = 2}).size(), 1U);
}

TEST(DetectKeypointsTest, FlatTornAndShortStacksHaveNone) {
  const Image<float> flat(64, 64, 3.0F);
  EXPECT_TRUE(DetectKeypoints(MiddleOfThree(flat), AllValid(flat)).empty());
  const Image<float> torn(64, 64, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(DetectKeypoints({torn, torn, torn}, AllValid(torn)).empty());
  const Image<float> blob = Blobs(64, 3.0, {{32.0, 32.0, 1.0}});
  EXPECT_TRUE(DetectKeypoints({}, AllValid(blob)).empty());
  EXPECT_TRUE(DetectKeypoints({blob}, AllValid(blob)).empty());
  EXPECT_TRUE(DetectKeypoints({flat, blob}, AllValid(blob)).empty());
  const Image<float> tiny(3, 3, 1.0F);
  EXPECT_TRUE(DetectKeypoints(MiddleOfThree(tiny), AllValid(tiny)).empty());
}

TEST(DetectKeypointsTest, QuarterTurnsOfTheImageTurnTheKeyPoints) {
  // An odd size: a quarter turn about the centre maps pixels, and the transform's origin, onto themselves.
  constexpr int kSize = 129;
  const Image<float> image = SmoothNoise(kSize, 11);
  Image<float> turned(kSize, kSize);
  for (int row = 0; row < kSize; ++row) {
    for (int col = 0; col < kSize; ++col) turned(col, kSize - 1 - row) = image(row, col);
  }
  const auto detect = [](const Image<float>& of) {
    const auto bands = ComputeScaleBands(of, ScaleBandOptions{.num_scales = 5});
    return DetectKeypoints(DifferenceOfCurvelets(*bands), AllValid(of));
  };
  const auto expected = detect(image);
  const auto keypoints = detect(turned);
  ASSERT_GT(expected.size(), 20U);
  EXPECT_EQ(keypoints.size(), expected.size());
  size_t num_found = 0;
  for (const Keypoint& keypoint : expected) {
    for (const Keypoint& other : keypoints) {
      const bool same = other.level == keypoint.level && std::abs(other.response - keypoint.response) < 1e-4F &&
                        std::abs(other.row - keypoint.col) < 0.01F &&
                        std::abs(other.col - (kSize - 1 - keypoint.row)) < 0.01F;
      num_found += static_cast<size_t>(same);
    }
  }
  EXPECT_EQ(num_found, expected.size());
}

TEST(DetectKeypointsTest, SameBytesAtAnyThreadCount) {
  const Image<float> image = SmoothNoise(128, 12);
  const auto bands = ComputeScaleBands(image, ScaleBandOptions{.num_scales = 5});
  const auto stack = DifferenceOfCurvelets(*bands);
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    for (const Keypoint& keypoint : DetectKeypoints(stack, AllValid(image))) {
      log.Add(keypoint.row);
      log.Add(keypoint.col);
      log.Add(keypoint.level);
      log.Add(keypoint.response);
    }
  });
}

}  // namespace
}  // namespace curvereg
