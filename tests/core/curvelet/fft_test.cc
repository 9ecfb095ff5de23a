// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/fft.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <thread>
#include <vector>

namespace curvereg {
namespace {

template <typename T>
class FftTest : public ::testing::Test {
 protected:
  static constexpr double kTolerance = sizeof(T) == 4 ? 2e-5 : 1e-13;
};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(FftTest, Precisions);

// A fixed image without symmetry, values within [-1, 1].
template <typename T>
std::vector<T> MakeImage(int rows, int cols) {
  std::vector<T> image;
  for (int i = 0; i < rows * cols; ++i) image.push_back(static_cast<T>(std::sin(1.7 * i * i + 0.3 * i)));
  return image;
}

// One value of the unnormalised DFT, straight from its definition.
template <typename T>
std::complex<double> DftAt(const std::vector<T>& image, FftShape shape, int k1, int k2) {
  std::complex<double> sum = 0.0;
  for (int row = 0; row < shape.rows; ++row) {
    for (int col = 0; col < shape.cols; ++col) {
      const double turns = static_cast<double>(k1 * row) / shape.rows + static_cast<double>(k2 * col) / shape.cols;
      sum += static_cast<double>(image[static_cast<size_t>(row * shape.cols + col)]) *
             std::polar(1.0, -2.0 * std::numbers::pi * turns);
    }
  }
  return sum;
}

TYPED_TEST(FftTest, RealForwardIsTheDft) {
  for (const FftShape shape : {FftShape{5, 7}, FftShape{6, 8}, FftShape{1, 1}, FftShape{1, 9}, FftShape{9, 1}}) {
    const std::vector<TypeParam> image = MakeImage<TypeParam>(shape.rows, shape.cols);
    const int half_cols = shape.cols / 2 + 1;
    FftBuffer<std::complex<TypeParam>> half(static_cast<size_t>(shape.rows * half_cols));
    GetFftPlan<TypeParam>(shape, FftKind::kRealToHalf)->Execute(image.data(), half.data());
    for (int k1 = 0; k1 < shape.rows; ++k1) {
      for (int k2 = 0; k2 < half_cols; ++k2) {
        const std::complex<double> value(half[static_cast<size_t>(k1 * half_cols + k2)]);
        EXPECT_LT(std::abs(value - DftAt(image, shape, k1, k2)), this->kTolerance * 10.0);
      }
    }
  }
}

TYPED_TEST(FftTest, RealRoundTripMultipliesByTheNumberOfPixels) {
  const FftShape shape{9, 14};
  const std::vector<TypeParam> image = MakeImage<TypeParam>(shape.rows, shape.cols);
  FftBuffer<std::complex<TypeParam>> half(9 * 8);
  std::vector<TypeParam> back(image.size());
  GetFftPlan<TypeParam>(shape, FftKind::kRealToHalf)->Execute(image.data(), half.data());
  GetFftPlan<TypeParam>(shape, FftKind::kHalfToReal)->Execute(half.data(), back.data());
  for (size_t i = 0; i < image.size(); ++i) EXPECT_NEAR(back[i] / 126, image[i], this->kTolerance);
}

TYPED_TEST(FftTest, ComplexRoundTripAndImpulse) {
  const FftShape shape{6, 5};
  FftBuffer<std::complex<TypeParam>> data(30);
  for (size_t i = 0; i < 30; ++i) data[i] = i == 7 ? TypeParam{1} : TypeParam{0};  // row 1, column 2
  GetFftPlan<TypeParam>(shape, FftKind::kForward)->Execute(data.data());
  for (int k1 = 0; k1 < 6; ++k1) {
    for (int k2 = 0; k2 < 5; ++k2) {
      const std::complex<double> wave = std::polar(1.0, -2.0 * std::numbers::pi * (k1 / 6.0 + 2.0 * k2 / 5.0));
      EXPECT_LT(std::abs(std::complex<double>(data[static_cast<size_t>(k1 * 5 + k2)]) - wave), this->kTolerance);
    }
  }
  GetFftPlan<TypeParam>(shape, FftKind::kInverse)->Execute(data.data());
  for (size_t i = 0; i < 30; ++i) EXPECT_NEAR(data[i].real() / 30, i == 7 ? 1.0 : 0.0, this->kTolerance);
}

TYPED_TEST(FftTest, ColumnsThenRowsAreTheWholeInverse) {
  const FftShape shape{12, 10};
  const std::vector<TypeParam> image = MakeImage<TypeParam>(shape.rows, shape.cols);
  FftBuffer<std::complex<TypeParam>> whole(12 * 6);
  FftBuffer<std::complex<TypeParam>> parts(12 * 6);
  GetFftPlan<TypeParam>(shape, FftKind::kRealToHalf)->Execute(image.data(), whole.data());
  for (size_t i = 0; i < whole.size(); ++i) {
    if (i % 6 >= 3) whole[i] = 0;  // columns 3, 4, 5 hold nothing
    parts[i] = whole[i];
  }
  std::vector<TypeParam> expected(image.size());
  std::vector<TypeParam> actual(image.size());
  GetFftPlan<TypeParam>(shape, FftKind::kHalfToReal)->Execute(whole.data(), expected.data());
  GetFftPlan<TypeParam>({12, 10, 3}, FftKind::kInverseColumns)->Execute(parts.data());
  GetFftPlan<TypeParam>(shape, FftKind::kHalfRowsToReal)->Execute(parts.data(), actual.data());
  for (size_t i = 0; i < image.size(); ++i) EXPECT_NEAR(actual[i], expected[i], 120 * this->kTolerance);
}

TYPED_TEST(FftTest, AlignmentOfTheImageDoesNotChangeTheBytes) {
  const FftShape shape{16, 15};
  const std::vector<TypeParam> image = MakeImage<TypeParam>(shape.rows, shape.cols);
  const auto forward = GetFftPlan<TypeParam>(shape, FftKind::kRealToHalf);
  FftBuffer<std::complex<TypeParam>> expected(16 * 8);
  forward->Execute(image.data(), expected.data());
  std::vector<TypeParam> shifted(image.size() + 1);
  std::copy(image.begin(), image.end(), shifted.begin() + 1);
  FftBuffer<std::complex<TypeParam>> actual(16 * 8);
  forward->Execute(shifted.data() + 1, actual.data());
  for (size_t i = 0; i < actual.size(); ++i) EXPECT_EQ(actual[i], expected[i]);
  GetFftPlan<TypeParam>(shape, FftKind::kHalfToReal)->Execute(actual.data(), shifted.data() + 1);
  std::vector<TypeParam> back(image.size());
  GetFftPlan<TypeParam>(shape, FftKind::kHalfToReal)->Execute(expected.data(), back.data());
  EXPECT_TRUE(std::equal(back.begin(), back.end(), shifted.begin() + 1));
}

TEST(FftPlanCacheTest, SharesPlansAndDropsOldOnes) {
  const auto first = GetFftPlan<float>({8, 8}, FftKind::kForward);
  EXPECT_EQ(GetFftPlan<float>({8, 8}, FftKind::kForward), first);
  EXPECT_NE(GetFftPlan<float>({8, 8}, FftKind::kInverse), first);
  const std::weak_ptr<const FftPlan<float>> old = GetFftPlan<float>({3, 3}, FftKind::kForward);
  EXPECT_FALSE(old.expired());
  for (int n = 1; n <= 128; ++n) GetFftPlan<float>({1, n}, FftKind::kForward);
  EXPECT_TRUE(old.expired());
  FftBuffer<std::complex<float>> data(64);
  std::fill(data.data(), data.data() + 64, 1.0F);
  first->Execute(data.data());  // dropped from the cache, alive in our hands
  EXPECT_FLOAT_EQ(data[0].real(), 64.0F);
}

TEST(FftPlanCacheTest, ServesThreadsAtOnce) {
  std::vector<std::thread> threads;
  std::vector<double> sums(4);
  for (size_t t = 0; t < sums.size(); ++t) {
    threads.emplace_back([&sums, t] {
      for (int n = 1; n <= 150; ++n) {
        FftBuffer<std::complex<double>> data(static_cast<size_t>(n));
        std::fill(data.data(), data.data() + n, 1.0);
        GetFftPlan<double>({1, n}, FftKind::kForward)->Execute(data.data());
        sums[t] += data[0].real();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const double sum : sums) EXPECT_NEAR(sum, 150 * 151 / 2, 1e-9);
}

}  // namespace
}  // namespace curvereg
