// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_transform.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/parallel.h"

namespace curvereg {
namespace {

using Complex = std::complex<double>;

Image<double> Noise(int rows, int cols) {
  Image<double> image(rows, cols);
  uint32_t state = 12345;
  for (double& pixel : image.pixels) {
    state = state * 1664525U + 1013904223U;
    pixel = state / 4294967296.0 - 0.5;
  }
  return image;
}

CurveletTransform Make(int rows, int cols, const CurveletOptions& options = {}) {
  auto transform = CurveletTransform::Create(rows, cols, options);
  EXPECT_TRUE(transform.ok()) << transform.status();
  return *transform;
}

template <typename Value>
double Energy(const Image<Value>& image) {
  double sum = 0.0;
  for (const Value& value : image.pixels) sum += std::norm(value);
  return sum;
}

template <typename Value>
double Energy(const CurveletCoefficients<Value>& curvelets) {
  double sum = 0.0;
  for (const auto& scale : curvelets.scales) {
    for (const auto& array : scale) sum += Energy(array);
  }
  return sum;
}

template <typename Value>
double MaxDifference(const Image<Value>& a, const Image<Value>& b) {
  double result = 0.0;
  for (size_t i = 0; i < a.size(); ++i) result = std::max(result, std::abs(a.pixels[i] - b.pixels[i]));
  return result;
}

TEST(CurveletTransformTest, IsATightFrameForEverySizeAndSetting) {
  for (const auto& [rows, cols] : {std::pair{12, 12}, {25, 49}, {48, 51}, {63, 64}, {97, 100}, {24, 144}, {131, 60}}) {
    for (const int num_angles : {8, 16, 32}) {
      for (const FinestScale finest : {FinestScale::kWavelets, FinestScale::kCurvelets}) {
        const CurveletOptions options{.num_angles_coarse = num_angles, .finest = finest};
        if (!ValidateCurveletOptions(rows, cols, options).ok()) continue;  // small image, many angles
        const CurveletTransform transform = Make(rows, cols, options);
        const Image<double> image = Noise(rows, cols);
        const auto curvelets = transform.Forward(image);
        EXPECT_NEAR(Energy(*curvelets) / Energy(image), 1.0, 1e-13) << rows << " x " << cols;
        EXPECT_LT(MaxDifference(*transform.Inverse(*curvelets), image), 1e-14) << rows << " x " << cols;
      }
    }
  }
}

TEST(CurveletTransformTest, ComplexImagesReconstruct) {
  const CurveletTransform transform = Make(63, 80, {.num_scales = 3, .finest = FinestScale::kCurvelets});
  const Image<double> noise = Noise(63, 160);
  Image<Complex> image(63, 80);
  for (size_t i = 0; i < image.size(); ++i) image.pixels[i] = {noise.pixels[2 * i], noise.pixels[2 * i + 1]};
  const auto curvelets = transform.ForwardComplex(image);
  EXPECT_NEAR(Energy(*curvelets) / Energy(image), 1.0, 1e-13);
  EXPECT_LT(MaxDifference(*transform.Inverse(*curvelets), image), 1e-14);
}

TEST(CurveletTransformTest, ZeroIsZeroAndAConstantIsCoarse) {
  const CurveletTransform transform = Make(60, 64);
  EXPECT_EQ(Energy(*transform.Forward(Image<double>(60, 64))), 0.0);
  const auto curvelets = transform.Forward(Image<double>(60, 64, 2.5));
  const auto info = transform.Array(1, 1);
  const double expected = 2.5 * std::sqrt(60.0 * 64.0 / (info.rows * info.cols));
  for (const double value : curvelets->scales[0][0].pixels) EXPECT_NEAR(value, expected, 1e-13);
  EXPECT_LT(Energy(*curvelets) - Energy(curvelets->scales[0][0]), 1e-20);
}

TEST(CurveletTransformTest, CosinesAndSinesAreTheComplexCurvelets) {
  const CurveletTransform transform = Make(61, 72, {.num_scales = 3});
  const Image<double> image = Noise(61, 72);
  const auto real = transform.Forward(image);
  const auto complex = transform.ForwardComplex(image);
  for (size_t l = 0; l < 8; ++l) {
    const Image<Complex>& array = complex->scales[1][l];
    for (size_t i = 0; i < array.size(); ++i) {
      EXPECT_NEAR(real->scales[1][l].pixels[i], std::numbers::sqrt2 * array.pixels[i].real(), 1e-15);
      EXPECT_NEAR(real->scales[1][l + 8].pixels[i], std::numbers::sqrt2 * array.pixels[i].imag(), 1e-15);
      EXPECT_EQ(complex->scales[1][l + 8].pixels[i], std::conj(array.pixels[i]));
    }
  }
}

TEST(CurveletTransformTest, AWaveIsFoundInTheWedgeOfItsDirection) {
  const CurveletTransform transform = Make(128, 128, {.num_scales = 4});
  for (const int angle : {2, 5, 9, 12, 16}) {
    const auto info = transform.Array(3, angle);
    Image<double> image(128, 128);
    for (int row = 0; row < 128; ++row) {
      for (int col = 0; col < 128; ++col) {
        const double turns = (0.6 * info.centre_k1 * row + 0.6 * info.centre_k2 * col) / 128.0;
        image(row, col) = std::cos(2.0 * std::numbers::pi * turns);
      }
    }
    const auto curvelets = transform.ForwardComplex(image);
    double best = -1.0;
    int best_angle = 0;
    for (int l = 1; l <= 16; ++l) {
      const double energy = Energy(curvelets->scales[2][static_cast<size_t>(l) - 1]);
      if (energy > best) best_angle = l;
      best = std::max(best, energy);
    }
    EXPECT_EQ(best_angle, angle);
    EXPECT_EQ(transform.Array(3, angle + 16).centre_k1, -info.centre_k1);
  }
}

// The energy of a single curvelet is centred where CoefficientPosition says.
TEST(CurveletTransformTest, PositionIsTheCentroidOfTheAtom) {
  for (const auto& [rows, cols] : {std::pair{96, 128}, {97, 131}, {128, 97}}) {
    const CurveletTransform transform = Make(rows, cols, {.num_scales = 4});
    for (const auto& [scale, angle] : {std::pair{1, 1}, {2, 3}, {2, 13}, {3, 1}, {3, 12}, {4, 1}}) {
      auto atom = *transform.ForwardComplex(Image<double>(rows, cols));
      Image<Complex>& array = atom.scales[static_cast<size_t>(scale) - 1][static_cast<size_t>(angle) - 1];
      const int row = array.rows / 4;
      const int col = 2 * array.cols / 3;
      array(row, col) = 1.0;
      const auto image = transform.Inverse(atom);
      const auto position = transform.CoefficientPosition(scale, angle, row, col);
      EXPECT_GE(position.row, 0.0);
      EXPECT_LT(position.col, cols);
      // Circular mean along each axis: the image is periodic.
      Complex mean_row = 0.0;
      Complex mean_col = 0.0;
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < cols; ++j) {
          const double weight = std::norm((*image)(i, j));
          mean_row += weight * std::polar(1.0, 2.0 * std::numbers::pi * (i - position.row) / rows);
          mean_col += weight * std::polar(1.0, 2.0 * std::numbers::pi * (j - position.col) / cols);
        }
      }
      EXPECT_NEAR(std::arg(mean_row) * rows / (2.0 * std::numbers::pi), 0.0, 1e-9) << scale << " " << angle;
      EXPECT_NEAR(std::arg(mean_col) * cols / (2.0 * std::numbers::pi), 0.0, 1e-9) << scale << " " << angle;
    }
  }
}

TEST(CurveletTransformTest, SameBytesAtAnyThreadCount) {
  const CurveletTransform transform = Make(97, 131, {.finest = FinestScale::kCurvelets});
  const Image<double> image = Noise(97, 131);
  const auto serial = transform.Forward(image);
  const auto serial_inverse = transform.Inverse(*serial);
  for (const int num_threads : {2, 4}) {
    WithThreadLimit(num_threads, [&] {
      const auto parallel = Make(97, 131, {.finest = FinestScale::kCurvelets}).Forward(image);
      for (size_t j = 0; j < serial->scales.size(); ++j) {
        for (size_t l = 0; l < serial->scales[j].size(); ++l) {
          EXPECT_EQ(parallel->scales[j][l].pixels, serial->scales[j][l].pixels);
        }
      }
      EXPECT_EQ(transform.Inverse(*parallel)->pixels, serial_inverse->pixels);
    });
  }
}

TEST(CurveletTransformTest, NonFinitePixelsDoNotCrash) {
  Image<double> image = Noise(48, 48);
  image(3, 4) = std::numeric_limits<double>::quiet_NaN();
  const auto curvelets = Make(48, 48).Forward(image);
  ASSERT_TRUE(curvelets.ok());
  EXPECT_TRUE(std::isnan(curvelets->scales[0][0].pixels[0]));
}

TEST(CurveletTransformTest, RefusesBadArguments) {
  EXPECT_EQ(CurveletTransform::Create(0, 5).status().message(), "image is empty: 0 x 5");
  EXPECT_FALSE(CurveletTransform::Create(64, 64, {.num_angles_coarse = 20}).ok());
  EXPECT_FALSE(CurveletTransform::Create(64, 64, {.num_scales = 5}).ok());
  const CurveletTransform transform = Make(64, 64, {.num_scales = 3});
  EXPECT_EQ(transform.Forward(Image<double>(64, 63)).status().message(), "image is 64 x 63, not 64 x 64");
  EXPECT_FALSE(transform.ForwardComplex(Image<Complex>(63, 64)).ok());
  auto curvelets = *transform.Forward(Image<double>(64, 64));
  EXPECT_EQ(transform.SingleScale(curvelets, 4).status().message(), "no scale 4; there are 1 to 3");
  EXPECT_FALSE(transform.SingleScale(curvelets, 0).ok());
  curvelets.scales[1][2] = Image<double>(3, 3);
  EXPECT_EQ(transform.Inverse(curvelets).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(transform.Inverse(curvelets).status().message()),
              ::testing::StartsWith("scale 2, array 3: image is 3 x 3, not "));
  curvelets.scales[1].pop_back();
  EXPECT_EQ(transform.Inverse(curvelets).status().message(), "scale 2 has 15 arrays, not 16");
  curvelets.scales.pop_back();
  EXPECT_EQ(transform.Inverse(curvelets).status().message(), "coefficients have 2 scales, not 3");
  EXPECT_FALSE(transform.Inverse(ComplexCurvelets()).ok());
}

}  // namespace
}  // namespace curvereg
