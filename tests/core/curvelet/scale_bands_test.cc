// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/scale_bands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "core/base/parallel.h"

namespace curvereg {
namespace {

constexpr WindowShape kShapes[] = {WindowShape::kCartesian, WindowShape::kPolar};

template <typename T>
Image<T> Noise(int rows, int cols) {
  Image<T> image(rows, cols);
  uint32_t state = 12345;
  for (T& pixel : image.pixels) {
    state = state * 1664525U + 1013904223U;
    pixel = static_cast<T>(state / 4294967296.0 - 0.5);
  }
  return image;
}

Image<double> Wave(int size, int k1, int k2) {
  Image<double> image(size, size);
  for (int row = 0; row < size; ++row) {
    for (int col = 0; col < size; ++col) {
      image(row, col) = std::cos(2.0 * std::numbers::pi * (k1 * row + k2 * col) / size);
    }
  }
  return image;
}

double MaxAbs(const Image<double>& image) {
  double result = 0.0;
  for (const double pixel : image.pixels) result = std::max(result, std::abs(pixel));
  return result;
}

// The gain of each band on a plane wave of (k1, k2) cycles per image.
std::vector<double> Gains(int size, int k1, int k2, WindowShape windows) {
  const auto bands = ComputeScaleBands(Wave(size, k1, k2), {.num_scales = 4, .windows = windows});
  std::vector<double> gains;
  for (const Image<double>& band : *bands) gains.push_back(MaxAbs(band));
  return gains;
}

TEST(ScaleBandsTest, BandsAddUpToTheImageAtAnySize) {
  for (const WindowShape windows : kShapes) {
    for (const auto& [rows, cols] : {std::pair{96, 96}, {97, 131}, {128, 97}, {90, 120}, {51, 48}}) {
      const Image<double> image = Noise<double>(rows, cols);
      const auto bands = ComputeScaleBands(image, {.num_scales = 4, .windows = windows});
      ASSERT_TRUE(bands.ok()) << bands.status();
      ASSERT_EQ(bands->size(), 4U);
      for (size_t i = 0; i < image.size(); ++i) {
        double sum = 0.0;
        for (const Image<double>& band : *bands) sum += band.pixels[i];
        ASSERT_NEAR(sum, image.pixels[i], 1e-14);
      }
    }
  }
}

TEST(ScaleBandsTest, SinglePrecisionFollowsDouble) {
  const Image<double> exact_image = Noise<double>(97, 131);
  Image<float> image(97, 131);
  std::copy(exact_image.pixels.begin(), exact_image.pixels.end(), image.pixels.begin());
  const auto exact = ComputeScaleBands(exact_image, {.num_scales = 5});
  const auto bands = ComputeScaleBands(image, {.num_scales = 5});
  for (size_t j = 0; j < 5; ++j) {
    for (size_t i = 0; i < image.size(); ++i) {
      ASSERT_NEAR((*bands)[j].pixels[i], (*exact)[j].pixels[i], 1e-6);
    }
  }
}

TEST(ScaleBandsTest, AConstantIsInTheCoarsestBandAndNyquistInTheFinest) {
  for (const WindowShape windows : kShapes) {
    const std::vector<double> constant = Gains(96, 0, 0, windows);
    const std::vector<double> nyquist = Gains(96, 48, 48, windows);
    for (size_t j = 0; j < 4; ++j) {
      EXPECT_NEAR(constant[j], j == 0 ? 1.0 : 0.0, 1e-14);
      EXPECT_NEAR(nyquist[j], j == 3 ? 1.0 : 0.0, 1e-14);
    }
  }
}

TEST(ScaleBandsTest, PolarWindowsDependOnTheWavelengthAlone) {
  // (25, 0), (15, 20), (7, 24) have equal length: the same wavelength in three directions.
  const std::vector<double> axis = Gains(96, 25, 0, WindowShape::kPolar);
  EXPECT_GT(axis[2], 0.05);
  EXPECT_GT(axis[3], 0.05);
  for (const auto& [k1, k2] : {std::pair{15, 20}, {-24, 7}}) {
    const std::vector<double> turned = Gains(96, k1, k2, WindowShape::kPolar);
    for (size_t j = 0; j < 4; ++j) EXPECT_NEAR(turned[j], axis[j], 1e-13);
  }
  // Square coronae do not.
  EXPECT_GT(std::abs(Gains(96, 15, 20, WindowShape::kCartesian)[3] - Gains(96, 25, 0, WindowShape::kCartesian)[3]),
            0.01);
}

TEST(ScaleBandsTest, GainIsTheSquaredStep) {
  // rho = 1/4 is the middle of the transition from 1/6 to 1/3, where the squared step is one half.
  const std::vector<double> gains = Gains(96, 24, 0, WindowShape::kPolar);
  EXPECT_NEAR(gains[3], 0.5, 1e-14);
  EXPECT_NEAR(gains[2], 0.5, 1e-14);
}

TEST(ScaleBandsTest, ARangeOfScalesEqualsThatPartOfAll) {
  const Image<float> image = Noise<float>(100, 110);
  const auto all = ComputeScaleBands(image, {.num_scales = 5});
  const auto part = ComputeScaleBands(image, {.num_scales = 5, .first_scale = 2, .last_scale = 4});
  ASSERT_EQ(part->size(), 3U);
  for (size_t j = 0; j < 3; ++j) EXPECT_EQ((*part)[j].pixels, (*all)[j + 1].pixels);
}

TEST(ScaleBandsTest, SameBytesAtAnyThreadCount) {
  const Image<float> image = Noise<float>(97, 131);
  const auto serial = ComputeScaleBands(image, {.num_scales = 5});
  for (const int num_threads : {2, 4}) {
    WithThreadLimit(num_threads, [&] {
      const auto parallel = ComputeScaleBands(image, {.num_scales = 5});
      for (size_t j = 0; j < 5; ++j) {
        EXPECT_EQ(std::memcmp((*parallel)[j].pixels.data(), (*serial)[j].pixels.data(), image.size() * sizeof(float)),
                  0);
      }
    });
  }
}

TEST(ScaleBandsTest, RefusesBadArguments) {
  const Image<float> image = Noise<float>(100, 110);
  EXPECT_EQ(ComputeScaleBands(Image<float>(), {}).status().message(), "image is empty: 0 x 0");
  EXPECT_EQ(ComputeScaleBands(image, {.num_scales = 6}).status().message(),
            "6 scales are too many for an image of 100 x 110; at most 5");
  EXPECT_EQ(ComputeScaleBands(image, {.num_scales = 1}).status().message(), "1 scales; at least 2 are needed");
  EXPECT_EQ(ComputeScaleBands(image, {.num_scales = 4, .first_scale = 0}).status().message(),
            "scales 0 to 4 are no range within 1 to 4");
  EXPECT_FALSE(ComputeScaleBands(image, {.num_scales = 4, .first_scale = 3, .last_scale = 2}).ok());
  EXPECT_FALSE(ComputeScaleBands(image, {.num_scales = 4, .last_scale = 5}).ok());
  const auto bands = ScaleBands<float>::Create(100, 110, {.num_scales = 4});
  EXPECT_EQ(bands->Compute(Noise<float>(110, 100)).status().message(), "image is 110 x 100, not 100 x 110");
  Image<float> torn(100, 110);
  torn.pixels.pop_back();
  EXPECT_EQ(bands->Compute(torn).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvereg
