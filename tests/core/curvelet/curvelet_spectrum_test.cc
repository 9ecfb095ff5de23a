// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/image.h"

namespace curvereg {
namespace {

using Complex = std::complex<double>;

Image<double> MakeImage(int rows, int cols) {
  Image<double> image(rows, cols);
  for (size_t i = 0; i < image.size(); ++i) {
    const auto x = static_cast<double>(i);
    image.pixels[i] = std::sin(1.7 * x * x + 0.3 * x);
  }
  return image;
}

// X(k1, k2) straight from its definition.
Complex CentredDft(const Image<double>& image, int k1, int k2) {
  Complex sum = 0.0;
  for (int row = 0; row < image.rows; ++row) {
    for (int col = 0; col < image.cols; ++col) {
      const double turns = static_cast<double>(k1 * (row - image.rows / 2)) / image.rows +
                           static_cast<double>(k2 * (col - image.cols / 2)) / image.cols;
      sum += image(row, col) * std::polar(1.0, -2.0 * std::numbers::pi * turns);
    }
  }
  return sum / std::sqrt(static_cast<double>(image.size()));
}

FftBuffer<Complex> HalfSpectrum(const Image<double>& image) {
  FftBuffer<Complex> half(static_cast<size_t>(image.rows * (image.cols / 2 + 1)));
  GetFftPlan<double>({image.rows, image.cols}, FftKind::kRealToHalf)->Execute(image.pixels.data(), half.data());
  return half;
}

class SpectrumFoldingTest : public ::testing::TestWithParam<std::pair<int, int>> {};
INSTANTIATE_TEST_SUITE_P(OddAndEven, SpectrumFoldingTest,
                         ::testing::Values(std::pair(12, 16), std::pair(13, 15), std::pair(12, 15), std::pair(15, 14)));

// The box of two thirds of the sampling frequency, wider than the half spectrum.
TEST_P(SpectrumFoldingTest, UnfoldIsTheCentredPeriodicDft) {
  const auto [rows, cols] = GetParam();
  const Image<double> image = MakeImage(rows, cols);
  const SpectrumFolding folding(rows, cols, 2 * rows / 3, 2 * cols / 3);
  const SpectrumBox box = folding.Unfold(HalfSpectrum(image).data());
  for (int k1 = -2 * rows / 3; k1 <= 2 * rows / 3; ++k1) {
    for (int k2 = k1 < 0 ? -2 * cols / 3 : 0; k2 <= 2 * cols / 3; ++k2) {
      EXPECT_LT(std::abs(box.Row(k1)[k2] - CentredDft(image, k1, k2)), 1e-12) << k1 << " " << k2;
    }
  }
}

TEST_P(SpectrumFoldingTest, FoldingOneFrequencyGivesItsWave) {
  const auto [rows, cols] = GetParam();
  const SpectrumFolding folding(rows, cols, 2 * rows / 3, 2 * cols / 3);
  const int k1 = -2 * rows / 3;
  const int k2 = cols / 3;
  SpectrumBox box(2 * rows / 3, 2 * cols / 3);
  std::fill_n(box.values.data(), box.values.size(), Complex(0.0));
  const Complex amplitude(0.6, -0.8);
  box.Row(k1)[k2] = amplitude;
  FftBuffer<Complex> half(static_cast<size_t>(rows * (cols / 2 + 1)));
  std::fill_n(half.data(), half.size(), Complex(0.0));
  folding.AddFolded(box, half.data());
  Image<double> image(rows, cols);
  GetFftPlan<double>({rows, cols}, FftKind::kHalfToReal)->Execute(half.data(), image.pixels.data());
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const double turns =
          static_cast<double>(k1 * (row - rows / 2)) / rows + static_cast<double>(k2 * (col - cols / 2)) / cols;
      const Complex wave = amplitude * std::polar(1.0, 2.0 * std::numbers::pi * turns);
      EXPECT_NEAR(image(row, col), 2.0 * wave.real() / std::sqrt(rows * cols), 1e-14);
    }
  }
}

TEST_P(SpectrumFoldingTest, AddAtUndoesUnfold) {
  const auto [rows, cols] = GetParam();
  const FftBuffer<Complex> expected = HalfSpectrum(MakeImage(rows, cols));
  const SpectrumFolding folding(rows, cols, rows / 2, cols / 2);
  const SpectrumBox box = folding.Unfold(expected.data());
  FftBuffer<Complex> half(expected.size());
  std::fill_n(half.data(), half.size(), Complex(0.0));
  for (int k1 = -((rows - 1) / 2); k1 <= rows / 2; ++k1) {
    for (int k2 = 0; k2 <= cols / 2; ++k2) folding.AddAt(k1, k2, box.Row(k1)[k2], half.data());
  }
  const double pixels = rows * cols;  // both ways carry 1 / sqrt(pixels)
  for (size_t i = 0; i < half.size(); ++i) EXPECT_LT(std::abs(half[i] * pixels - expected[i]), 1e-12);
}

}  // namespace
}  // namespace curvereg
