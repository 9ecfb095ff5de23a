// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The curvelet transform against reference numbers: all files of tests/data/fdct_golden, or of the folder that
// CURVEREG_FDCT_GOLDEN names (format fdct-wrapping-golden-1; cases of flavour C are not ours and skipped aloud).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/curvelet/curvelet_transform.h"
#include "core/curvelet/scale_bands.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using Complex = std::complex<double>;
using ComplexImage = Image<Complex>;
using nlohmann::json;

// Coefficients differ by the reference's own cancellation in sqrt(1 - L^2); all else is rounding.
constexpr double kCoefficientTolerance = 1e-8;
constexpr double kScaleTolerance = 1e-12;
constexpr double kThresholdTolerance = 1e-7;
constexpr double kReconstructionTolerance = 1e-13;

// A linear congruential generator, uniform in [-0.5, 0.5).
class Lcg {
 public:
  double Next() {
    state_ = state_ * 1664525U + 1013904223U;
    return state_ / 4294967296.0 - 0.5;
  }

 private:
  uint32_t state_ = 12345;
};

double WavesEdges(int64_t i, int64_t j, int64_t N1, int64_t N2) {
  const int64_t m = std::min(N1, N2);
  const int64_t u = 30 * i - 15 * N1;
  const int64_t v = 30 * j - 10 * N2;
  const double wave = std::sin(2.0 * std::numbers::pi *
                               (3.0 * static_cast<double>(i) / static_cast<double>(N1) +
                                5.0 * static_cast<double>(j) / static_cast<double>(N2)));
  return wave + (10 * j > 4 * N2 + 2 * i ? 1.0 : 0.0) - (u * u + v * v < 36 * m * m ? 0.7 : 0.0);
}

ComplexImage MakeInput(const std::string& name, int N1, int N2) {
  ComplexImage image(N1, N2);
  Lcg lcg;
  for (int i = 0; i < N1; ++i) {
    for (int j = 0; j < N2; ++j) {
      Complex& pixel = image(i, j);
      if (name == "waves_edges") {
        pixel = WavesEdges(i, j, N1, N2);
      } else if (name == "chirp") {
        pixel = std::cos(std::numbers::pi * (0.37 * i * i / N1 + 0.21 * j * j / N2));
      } else if (name == "delta") {
        pixel = i == N1 / 3 && j == N2 / 4 ? 1.0 : 0.0;
      } else if (name == "delta_center") {
        pixel = i == N1 / 2 && j == N2 / 2 ? 1.0 : 0.0;
      } else if (name == "lcg" || name == "lcg_complex") {
        const double real = lcg.Next();
        pixel = Complex(real, name == "lcg_complex" ? lcg.Next() : 0.0);
      } else {
        ADD_FAILURE() << "unknown input " << name;
        return image;
      }
    }
  }
  return image;
}

template <typename Value>
ComplexImage AsComplex(const Image<Value>& image) {
  ComplexImage result(image.rows, image.cols);
  std::copy(image.pixels.begin(), image.pixels.end(), result.pixels.begin());
  return result;
}

Image<double> RealPart(const ComplexImage& image) {
  Image<double> result(image.rows, image.cols);
  for (size_t i = 0; i < image.size(); ++i) result.pixels[i] = image.pixels[i].real();
  return result;
}

Complex AsComplex(const json& value) {
  return value.is_array() ? Complex(value[0].get<double>(), value[1].get<double>()) : Complex(value.get<double>());
}

// Weighted by a pattern without symmetry, so that transposed, turned and shifted arrays are told apart.
double Weight(int row, int col) { return ((7 * row + 13 * col) % 101) / 101.0; }

struct Sums {
  double l1 = 0.0;
  double l2 = 0.0;
  Complex sum = 0.0;
  Complex weighted = 0.0;
  double max_abs = 0.0;
};

Sums Summarise(const ComplexImage& image) {
  Sums sums;
  for (int row = 0; row < image.rows; ++row) {
    for (int col = 0; col < image.cols; ++col) {
      const Complex value = image(row, col);
      sums.l1 += std::abs(value);
      sums.l2 += std::norm(value);
      sums.sum += value;
      sums.weighted += Weight(row, col) * value;
      sums.max_abs = std::max(sums.max_abs, std::abs(value));
    }
  }
  sums.l2 = std::sqrt(sums.l2);
  return sums;
}

void ExpectNear(Complex actual, Complex expected, double tolerance, const std::string& what) {
  EXPECT_LE(std::abs(actual - expected), tolerance) << what << ": " << actual << ", expected " << expected;
}

// What a sum may be off when each value may be off by `tolerance`: random errors, and the rounding of summation.
double SumTolerance(const Sums& sums, size_t count, double tolerance) {
  return tolerance * std::sqrt(static_cast<double>(count)) + 1e-13 * sums.l1;
}

// `tolerance` is of one pixel.
void ExpectImage(const ComplexImage& image, const json& summary, const json& positions, double tolerance) {
  const Sums sums = Summarise(image);
  const double sum_tolerance = SumTolerance(sums, image.size(), tolerance);
  ExpectNear(sums.l2, summary["l2"].get<double>(), sum_tolerance, "l2");
  ExpectNear(sums.sum, AsComplex(summary["sum"]), sum_tolerance, "sum");
  ExpectNear(sums.weighted, AsComplex(summary["wsum"]), sum_tolerance, "wsum");
  if (summary.contains("maxabs")) {
    ExpectNear(sums.max_abs, summary["maxabs"].get<double>(), tolerance, "maxabs");
  } else {
    const Image<double> real = RealPart(image);
    const auto [least, greatest] = std::minmax_element(real.pixels.begin(), real.pixels.end());
    ExpectNear(*least, summary["min"].get<double>(), tolerance, "min");
    ExpectNear(*greatest, summary["max"].get<double>(), tolerance, "max");
  }
  for (size_t i = 0; i < positions.size(); ++i) {
    ExpectNear(image(positions[i][0], positions[i][1]), AsComplex(summary["pix"][i]), tolerance, "pixel");
  }
}

// A reference case run with one kind of coefficients, real or complex.
template <typename Curvelets>
class Case {
 public:
  explicit Case(const json& reference)
      : reference_(reference),
        input_(MakeInput(reference["input"], reference["N1"], reference["N2"])),
        max_pixel_(Summarise(input_).max_abs) {}

  void Run() {
    ExpectImage(input_, reference_["input_check"], reference_["pix_positions"], 1e-12);
    const CurveletOptions options{
        .num_scales = reference_["J"],
        .num_angles_coarse = reference_["nbc"],
        .finest = reference_["finest"] == 1 ? FinestScale::kCurvelets : FinestScale::kWavelets};
    auto transform = CurveletTransform::Create(reference_["N1"], reference_["N2"], options);
    ASSERT_TRUE(transform.ok()) << transform.status();
    auto curvelets = Forward(*transform);
    ASSERT_TRUE(curvelets.ok()) << curvelets.status();
    ExpectWedges(*curvelets);
    ExpectReconstruction(*transform, *curvelets);
    ExpectScales(*transform, *curvelets);
    if (reference_.contains("threshold")) ExpectThresholds(*transform, *curvelets);
  }

 private:
  absl::StatusOr<Curvelets> Forward(const CurveletTransform& transform) const {
    if constexpr (std::is_same_v<Curvelets, RealCurvelets>) {
      return transform.Forward(RealPart(input_));
    } else {
      return reference_["input_complex"].get<bool>() ? transform.ForwardComplex(input_)
                                                     : transform.ForwardComplex(RealPart(input_));
    }
  }

  void ExpectWedges(const Curvelets& curvelets) const {
    const double tolerance = kCoefficientTolerance * reference_["coef_max"].get<double>();
    double energy = 0.0;
    double max_abs = 0.0;
    size_t count = 0;
    size_t next = 0;
    ASSERT_EQ(curvelets.scales.size(), reference_["nb_per_scale"].size());
    for (size_t j = 1; j <= curvelets.scales.size(); ++j) {
      ASSERT_EQ(curvelets.scales[j - 1].size(), reference_["nb_per_scale"][j - 1]);
      for (size_t l = 1; l <= curvelets.scales[j - 1].size(); ++l) {
        const json& row = reference_["wedges"][next++];
        SCOPED_TRACE(::testing::Message() << "scale " << j << " array " << l);
        ASSERT_EQ(row[0], j);
        ASSERT_EQ(row[1], l);
        const ComplexImage array = AsComplex(curvelets.scales[j - 1][l - 1]);
        ExpectArray(array, row, tolerance);
        const Sums sums = Summarise(array);
        energy += sums.l2 * sums.l2;
        max_abs = std::max(max_abs, sums.max_abs);
        count += array.size();
      }
    }
    EXPECT_EQ(next, reference_["wedges"].size());
    EXPECT_EQ(count, reference_["coef_count"]);
    EXPECT_NEAR(max_abs, reference_["coef_max"].get<double>(), tolerance);
    EXPECT_NEAR(energy / reference_["coef_energy"].get<double>(), 1.0, 1e-12);
    EXPECT_NEAR(energy / std::pow(Summarise(input_).l2, 2), 1.0, 1e-12);
  }

  static void ExpectArray(const ComplexImage& array, const json& row, double tolerance) {
    ASSERT_EQ(array.rows, row[2]);
    ASSERT_EQ(array.cols, row[3]);
    const Sums sums = Summarise(array);
    const double sum_tolerance = SumTolerance(sums, array.size(), tolerance);
    const auto expected = [&row](size_t i) { return Complex(row[i].get<double>(), row[i + 1].get<double>()); };
    ExpectNear(sums.l2, row[4].get<double>(), sum_tolerance, "l2");
    ExpectNear(sums.sum, expected(5), sum_tolerance, "sum");
    ExpectNear(sums.weighted, expected(7), sum_tolerance, "wsum");
    ExpectNear(array(0, 0), expected(9), tolerance, "first");
    ExpectNear(array(array.rows / 2, array.cols / 2), expected(11), tolerance, "middle");
    ExpectNear(array(array.rows / 3, 2 * array.cols / 3), expected(13), tolerance, "third");
  }

  void ExpectReconstruction(const CurveletTransform& transform, const Curvelets& curvelets) const {
    const auto inverse = transform.Inverse(curvelets);
    ASSERT_TRUE(inverse.ok()) << inverse.status();
    const ComplexImage image = AsComplex(*inverse);
    double error = 0.0;
    for (size_t i = 0; i < image.size(); ++i) error = std::max(error, std::abs(image.pixels[i] - input_.pixels[i]));
    EXPECT_LE(error, kReconstructionTolerance * max_pixel_);
  }

  // Single scales of the transform, and the same by Fourier multipliers.
  void ExpectScales(const CurveletTransform& transform, const Curvelets& curvelets) const {
    const auto bands =
        ComputeScaleBands(RealPart(input_), {.num_scales = reference_["J"], .windows = WindowShape::kCartesian});
    ASSERT_TRUE(bands.ok()) << bands.status();
    for (const json& summary : reference_["scales"]) {
      const int j = summary["j"];
      SCOPED_TRACE(::testing::Message() << "single scale " << j);
      const auto single = transform.SingleScale(curvelets, j);
      ASSERT_TRUE(single.ok()) << single.status();
      const ComplexImage image = AsComplex(*single);
      ExpectImage(image, summary, reference_["pix_positions"], kScaleTolerance * max_pixel_);
      double error = 0.0;
      const Image<double>& band = (*bands)[static_cast<size_t>(j) - 1];
      for (size_t i = 0; i < image.size(); ++i) {
        error = std::max(error, std::abs(image.pixels[i].real() - band.pixels[i]));
      }
      EXPECT_LE(error, kScaleTolerance * max_pixel_) << "scale bands";
    }
  }

  void ExpectThresholds(const CurveletTransform& transform, const Curvelets& curvelets) const {
    const json& reference = reference_["threshold"];
    Curvelets hard = curvelets;
    HardThreshold(reference["tau"].get<double>(), hard);
    Curvelets soft = curvelets;
    SoftThreshold(reference["tau"].get<double>(), soft);
    for (size_t j = 2; j <= hard.scales.size(); ++j) {
      ptrdiff_t kept = 0;
      for (const auto& array : hard.scales[j - 1]) {
        kept += std::count_if(array.pixels.begin(), array.pixels.end(), [](auto c) { return c != 0.0; });
      }
      EXPECT_EQ(kept, reference["kept_per_scale_from_2"][j - 2]) << "scale " << j;
    }
    for (const auto& [name, thresholded] : {std::pair{"hard", &hard}, {"soft", &soft}}) {
      for (const json& summary : reference[name]) {
        const int j = summary["j"];
        SCOPED_TRACE(::testing::Message() << name << " threshold, scale " << j << " (0: all)");
        const auto image = j == 0 ? transform.Inverse(*thresholded) : transform.SingleScale(*thresholded, j);
        ASSERT_TRUE(image.ok()) << image.status();
        ExpectImage(AsComplex(*image), summary, reference_["pix_positions"], kThresholdTolerance);
      }
    }
  }

  const json& reference_;
  ComplexImage input_;
  double max_pixel_;
};

std::string GoldenFolder() {
  const char* folder = std::getenv("CURVEREG_FDCT_GOLDEN");
  return folder != nullptr ? folder : testing::TestDataPath("fdct_golden");
}

TEST(CurveletGoldenTest, EveryCaseOfTheFolder) {
  int num_cases = 0;
  int num_skipped = 0;
  for (const auto& entry : std::filesystem::directory_iterator(GoldenFolder())) {
    if (entry.path().extension() != ".json") continue;
    std::ifstream file(entry.path());
    const json golden = json::parse(file, nullptr, /*allow_exceptions=*/false);
    ASSERT_EQ(golden.value("format", ""), "fdct-wrapping-golden-1") << entry.path();
    for (const json& reference : golden["cases"]) {
      if (reference["flavour"] != "M") {
        std::cout << "skipped, not flavour M: " << reference["id"] << std::endl;
        ++num_skipped;
        continue;
      }
      SCOPED_TRACE(reference["id"].get<std::string>());
      ++num_cases;
      if (reference["is_real"] == 1) {
        Case<RealCurvelets>(reference).Run();
      } else {
        Case<ComplexCurvelets>(reference).Run();
      }
    }
  }
  std::cout << num_cases << " cases of flavour M checked, " << num_skipped << " of another flavour skipped"
            << std::endl;
  if (num_cases == 0 && num_skipped > 0) GTEST_SKIP() << "no case of flavour M in " << GoldenFolder();
  EXPECT_GT(num_cases, 0) << "no reference case in " << GoldenFolder();
}

}  // namespace
}  // namespace curvereg
