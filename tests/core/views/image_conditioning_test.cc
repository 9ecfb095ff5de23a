// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/views/image_conditioning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

Image<float> Plane(int rows, int cols, double a, double b, double c) {
  Image<float> image(rows, cols);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) image(row, col) = static_cast<float>(a + b * row + c * col);
  }
  return image;
}

// Valid at random with the given share.
Image<uint8_t> RandomMask(int rows, int cols, double share, uint64_t seed) {
  testing::Random random(seed);
  Image<uint8_t> valid(rows, cols);
  for (uint8_t& pixel : valid.pixels) pixel = random.Uniform() < share ? 1 : 0;
  return valid;
}

TEST(FillHolesTest, KeepsValidPixelsAndFillsTheOthersSmoothly) {
  const Image<float> truth = Plane(61, 90, -2.0, 0.02, 0.01);
  const Image<uint8_t> valid = RandomMask(61, 90, 0.5, 3);
  Image<float> image = truth;
  for (size_t i = 0; i < image.size(); ++i) {
    if (valid.pixels[i] == 0) image.pixels[i] = 1000.0F;
  }
  FillHoles(valid, image);
  double largest = 0.0;
  for (size_t i = 0; i < image.size(); ++i) {
    if (valid.pixels[i] != 0) {
      EXPECT_EQ(image.pixels[i], truth.pixels[i]);
    }
    largest = std::max<double>(largest, std::abs(image.pixels[i] - truth.pixels[i]));
  }
  EXPECT_LT(largest, 0.1);  // the plane changes by this much over 4 to 5 pixels
}

TEST(FillHolesTest, AHoleInAPlaneIsFilledWithItsValuesWithinAFewPixelsOfSlope) {
  const Image<float> truth = Plane(64, 64, 1.0, 0.02, -0.01);
  Image<uint8_t> valid(64, 64, 1);
  Image<float> image = truth;
  for (int row = 28; row < 36; ++row) {
    for (int col = 28; col < 36; ++col) valid(row, col) = 0;
  }
  FillHoles(valid, image);
  for (size_t i = 0; i < image.size(); ++i) EXPECT_NEAR(image.pixels[i], truth.pixels[i], 0.06);
}

TEST(FillHolesTest, StaysWithinTheRangeOfTheValidPixels) {
  testing::Random random(8);
  const Image<uint8_t> valid = RandomMask(33, 47, 0.1, 9);
  Image<float> image(33, 47);
  for (float& pixel : image.pixels) pixel = static_cast<float>(random.Uniform(3.0, 4.0));
  FillHoles(valid, image);
  EXPECT_GE(*std::min_element(image.pixels.begin(), image.pixels.end()), 3.0F - 1e-5F);
  EXPECT_LE(*std::max_element(image.pixels.begin(), image.pixels.end()), 4.0F + 1e-5F);
}

TEST(FillHolesTest, OneValidPixelFillsAll) {
  Image<uint8_t> valid(5, 7);
  Image<float> image(5, 7);
  valid(4, 2) = 1;
  image(4, 2) = 2.5F;
  FillHoles(valid, image);
  for (const float pixel : image.pixels) EXPECT_FLOAT_EQ(pixel, 2.5F);
}

TEST(FillHolesTest, WhatInvalidPixelsHeldDoesNotMatter) {
  const Image<uint8_t> valid = RandomMask(20, 20, 0.5, 4);
  Image<float> expected = Plane(20, 20, 0.0, 0.1, 0.1);
  Image<float> image = expected;
  for (size_t i = 0; i < image.size(); ++i) {
    if (valid.pixels[i] == 0) image.pixels[i] = std::numeric_limits<float>::quiet_NaN();
  }
  FillHoles(valid, expected);
  FillHoles(valid, image);
  EXPECT_EQ(image.pixels, expected.pixels);
}

TEST(FillHolesTest, WithoutValidPixelsTheImageIsZero) {
  Image<float> image(6, 5, 7.0F);
  FillHoles(Image<uint8_t>(6, 5), image);
  EXPECT_EQ(image.pixels, std::vector<float>(30, 0.0F));
  Image<float> empty;
  FillHoles(Image<uint8_t>(), empty);
  EXPECT_TRUE(empty.empty());
}

TEST(RemoveSpikesTest, MarksWhatStandsOutInvalid) {
  const Image<float> plane = Plane(20, 20, 1.0, 0.01, 0.02);
  Image<float> image = plane;
  image(10, 10) += 0.5F;
  image(3, 15) -= 0.5F;
  image(0, 0) += 0.5F;
  image(15, 5) += 0.2F;  // within the limit
  Image<uint8_t> valid(20, 20, 1);
  RemoveSpikes(2, 0.3F, image, valid);
  for (int row = 0; row < 20; ++row) {
    for (int col = 0; col < 20; ++col) {
      EXPECT_EQ(valid(row, col), std::abs(image(row, col) - plane(row, col)) > 0.3F ? 0 : 1) << row << " " << col;
    }
  }
}

TEST(RemoveSpikesTest, PixelsWithoutTwoNeighboursAreDropped) {
  Image<uint8_t> valid(20, 20);
  valid(3, 3) = valid(3, 4) = 1;                      // a pair
  valid(12, 12) = valid(12, 13) = valid(13, 12) = 1;  // three
  RemoveSpikes(2, 0.3F, Image<float>(20, 20, 1.0F), valid);
  EXPECT_EQ(std::accumulate(valid.pixels.begin(), valid.pixels.end(), 0), 3);
  EXPECT_EQ(valid(12, 12), 1);
  Image<uint8_t> none(20, 20);
  RemoveSpikes(2, 0.3F, Image<float>(20, 20, 1.0F), none);
  EXPECT_EQ(std::accumulate(none.pixels.begin(), none.pixels.end(), 0), 0);
}

TEST(GaussianBlur3x3Test, SpreadsAnImpulseByTheGaussian) {
  Image<float> image(7, 7);
  image(3, 3) = 1.0F;
  GaussianBlur3x3(0.5, image);
  const double side = std::exp(-0.5 / 0.25);
  const double total = 1.0 + 2.0 * side;
  EXPECT_NEAR(image(3, 3), 1.0 / (total * total), 1e-6);
  EXPECT_NEAR(image(3, 4), side / (total * total), 1e-6);
  EXPECT_NEAR(image(2, 2), side * side / (total * total), 1e-6);
  EXPECT_EQ(image(3, 5), 0.0F);
}

TEST(GaussianBlur3x3Test, KeepsConstantsUpToTheBorder) {
  Image<float> image(4, 9, 3.0F);
  GaussianBlur3x3(0.5, image);
  for (const float pixel : image.pixels) EXPECT_NEAR(pixel, 3.0, 1e-6);
}

TEST(GaussianBlur3x3Test, WithoutSigmaNothingChanges) {
  const Image<float> before = Plane(5, 6, 1.0, 2.0, -1.0);
  Image<float> image = before;
  GaussianBlur3x3(0.0, image);
  GaussianBlur3x3(-1.0, image);
  EXPECT_EQ(image.pixels, before.pixels);
  Image<float> single(1, 1, 2.0F);
  GaussianBlur3x3(0.5, single);
  EXPECT_NEAR(single(0, 0), 2.0, 1e-6);
}

TEST(DetrendTest, SubtractsThePlaneOfTheValidPixels) {
  const Image<uint8_t> valid = RandomMask(50, 70, 0.3, 5);
  Image<float> image = Plane(50, 70, -1.5, 0.03, -0.02);
  for (size_t i = 0; i < image.size(); ++i) {
    if (valid.pixels[i] == 0) image.pixels[i] += 1.0F;  // must not pull the plane
  }
  Detrend(valid, image);
  for (size_t i = 0; i < image.size(); ++i) EXPECT_NEAR(image.pixels[i], valid.pixels[i] != 0 ? 0.0 : 1.0, 1e-4);
}

TEST(DetrendTest, LeavesNoPlaneBehind) {
  testing::Random random(6);
  Image<float> image = Plane(40, 30, 2.0, 0.1, 0.2);
  for (float& pixel : image.pixels) pixel += static_cast<float>(random.Gaussian());
  Detrend(Image<uint8_t>(40, 30, 1), image);
  double sum = 0.0, along_rows = 0.0, along_cols = 0.0;
  for (int row = 0; row < 40; ++row) {
    for (int col = 0; col < 30; ++col) {
      sum += image(row, col);
      along_rows += (row - 19.5) / 40.0 * image(row, col);
      along_cols += (col - 14.5) / 30.0 * image(row, col);
    }
  }
  EXPECT_NEAR(sum / 1200, 0.0, 1e-4);
  EXPECT_NEAR(along_rows / 1200, 0.0, 1e-4);
  EXPECT_NEAR(along_cols / 1200, 0.0, 1e-4);
}

TEST(DetrendTest, DegenerateMasksGiveFiniteImages) {
  Image<uint8_t> line(20, 20);
  for (int col = 0; col < 20; ++col) line(7, col) = 1;
  Image<uint8_t> point(20, 20);
  point(3, 3) = 1;
  for (const Image<uint8_t>& valid : {Image<uint8_t>(20, 20), point, line}) {
    Image<float> image = Plane(20, 20, 1.0, 0.1, 0.2);
    Detrend(valid, image);
    for (const float pixel : image.pixels) EXPECT_LT(std::abs(pixel), 100.0F);
  }
  Image<float> image = Plane(20, 20, 1.0, 0.0, 0.2);
  Detrend(line, image);
  for (int col = 0; col < 20; ++col) EXPECT_NEAR(image(7, col), 0.0, 1e-4);
}

TEST(ApodizeTest, RaisedCosineFromZeroAtTheBorderToOne) {
  Image<float> image(20, 30, 1.0F);
  Apodize(4, image);
  for (int col = 0; col < 30; ++col) {
    EXPECT_EQ(image(0, col), 0.0F);
    EXPECT_EQ(image(19, col), 0.0F);
  }
  EXPECT_NEAR(image(10, 1), 0.5 - 0.5 * std::cos(0.25 * M_PI), 1e-6);
  EXPECT_NEAR(image(10, 2), 0.5, 1e-6);
  EXPECT_NEAR(image(10, 27), 0.5, 1e-6);
  EXPECT_NEAR(image(2, 2), 0.25, 1e-6);
  for (int row = 4; row < 16; ++row) {
    for (int col = 4; col < 26; ++col) EXPECT_EQ(image(row, col), 1.0F);
  }
}

TEST(ApodizeTest, WithoutWidthNothingChanges) {
  Image<float> image(5, 6, 1.0F);
  Apodize(0, image);
  EXPECT_EQ(image.pixels, std::vector<float>(30, 1.0F));
}

TEST(ValidFractionTest, CountsTheWindowInsideTheImage) {
  const Image<uint8_t> valid = RandomMask(13, 17, 0.6, 2);
  const Image<float> share = ValidFraction(valid, 2);
  for (int row = 0; row < 13; ++row) {
    for (int col = 0; col < 17; ++col) {
      int num_pixels = 0, num_valid = 0;
      for (int r = row - 2; r <= row + 2; ++r) {
        for (int c = col - 2; c <= col + 2; ++c) {
          if (!valid.Contains(r, c)) continue;
          ++num_pixels;
          num_valid += valid(r, c);
        }
      }
      EXPECT_NEAR(share(row, col), static_cast<double>(num_valid) / num_pixels, 1e-6);
    }
  }
}

TEST(ValidFractionTest, WindowLargerThanTheImage) {
  Image<uint8_t> valid(2, 3, 1);
  valid(0, 0) = 0;
  for (const float share : ValidFraction(valid, 100).pixels) EXPECT_NEAR(share, 5.0 / 6.0, 1e-6);
  EXPECT_TRUE(ValidFraction(Image<uint8_t>(), 4).empty());
}

}  // namespace
}  // namespace curvereg
