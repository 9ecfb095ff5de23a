// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_transform.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"

namespace curvereg {
namespace {

using Complex = std::complex<double>;

template <typename Value>
Image<Value>& ArrayAt(CurveletCoefficients<Value>& curvelets, int scale, int angle) {
  return curvelets.scales[static_cast<std::size_t>(scale) - 1][static_cast<std::size_t>(angle) - 1];
}
template <typename Value>
const Image<Value>& ArrayAt(const CurveletCoefficients<Value>& curvelets, int scale, int angle) {
  return curvelets.scales[static_cast<std::size_t>(scale) - 1][static_cast<std::size_t>(angle) - 1];
}

// Calls visit(natural index, stored index) for each coefficient of a wedge: offset 0 is stored in the middle, at index
// floor(n / 2) of both axes, and first in natural order.
template <typename Visit>
void ForEachCoefficient(const CurveletWedge& wedge, const Visit& visit) {
  const int middle = wedge.cols / 2;
  for (int row = 0; row < wedge.rows; ++row) {
    const std::size_t natural = static_cast<std::size_t>(row) * static_cast<std::size_t>(wedge.cols);
    const std::size_t stored =
        static_cast<std::size_t>((row + wedge.rows / 2) % wedge.rows) * static_cast<std::size_t>(wedge.cols);
    for (int col = 0; col < wedge.cols - middle; ++col) {
      visit(natural + static_cast<std::size_t>(col), stored + static_cast<std::size_t>(col + middle));
    }
    for (int col = wedge.cols - middle; col < wedge.cols; ++col) {
      visit(natural + static_cast<std::size_t>(col), stored + static_cast<std::size_t>(col + middle - wedge.cols));
    }
  }
}

Image<double> Part(const Image<Complex>& image, bool imaginary) {
  Image<double> part(image.rows, image.cols);
  for (std::size_t i = 0; i < image.size(); ++i)
    part.pixels[i] = imaginary ? image.pixels[i].imag() : image.pixels[i].real();
  return part;
}

template <typename Value>
absl::Status CheckImage(const Image<Value>& image, int rows, int cols) {
  if (image.rows == rows && image.cols == cols && image.size() == image.Index(rows, 0)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("image is ", image.rows, " x ", image.cols, ", not ", rows, " x ", cols));
}

// Half of a complex coefficient set as that of a real image. The transform of a + i b, a and b real, has C = A + i B
// in wedge l and C' = conj A + i conj B in the wedge opposite, so A = (C + conj C') / 2, i B = (C - conj C') / 2.
CurveletFrame::Source ComplexSource(const ComplexCurvelets& curvelets, bool imaginary) {
  CurveletFrame::Source source;
  source.wavelet = [&curvelets, imaginary](int scale) { return Part(ArrayAt(curvelets, scale, 1), imaginary); };
  source.wedge = [&curvelets, imaginary](const CurveletWedge& wedge, Complex* array) {
    const auto num_angles = static_cast<int>(curvelets.scales[static_cast<std::size_t>(wedge.scale) - 1].size());
    const Complex* same = ArrayAt(curvelets, wedge.scale, wedge.angle).pixels.data();
    const Complex* opposite = ArrayAt(curvelets, wedge.scale, wedge.angle + num_angles / 2).pixels.data();
    ForEachCoefficient(wedge, [&](std::size_t natural, std::size_t stored) {
      const Complex difference = same[stored] - std::conj(opposite[stored]);
      array[natural] = imaginary ? 0.5 * Complex(difference.imag(), -difference.real())
                                 : 0.5 * (same[stored] + std::conj(opposite[stored]));
    });
  };
  return source;
}

}  // namespace

CurveletTransform::CurveletTransform(int rows, int cols, const CurveletOptions& options)
    : rows_(rows), cols_(cols), options_(options), frame_(std::make_shared<const CurveletFrame>(rows, cols, options)) {}

absl::StatusOr<CurveletTransform> CurveletTransform::Create(int rows, int cols, const CurveletOptions& options) {
  if (absl::Status status = ValidateCurveletOptions(rows, cols, options); !status.ok()) return status;
  CurveletOptions filled = options;
  if (filled.num_scales == 0) filled.num_scales = DefaultNumScales(rows, cols);
  return CurveletTransform(rows, cols, filled);
}

CurveletTransform::ArrayInfo CurveletTransform::Array(int scale, int angle) const {
  if (scale == 1) return {.rows = frame_->coarsest_rows(), .cols = frame_->coarsest_cols()};
  if (frame_->HasWavelet(scale)) return {.rows = rows_, .cols = cols_};
  const int half = NumArrays(scale) / 2;
  const bool is_opposite = angle > half;
  const CurveletWedge& wedge = frame_->WedgeAt(scale, is_opposite ? angle - half : angle);
  const double sign = is_opposite ? -1.0 : 1.0;
  return {wedge.rows, wedge.cols, sign * wedge.centre_k1, sign * wedge.centre_k2};
}

CurveletTransform::Position CurveletTransform::CoefficientPosition(int scale, int angle, int row, int col) const {
  const ArrayInfo array = Array(scale, angle);
  const auto along = [](int image_size, int array_size, int index) {
    const double spacing = static_cast<double>(image_size) / array_size;
    const double position = image_size / 2 + (index - array_size / 2) * spacing;
    return position < 0.0 ? position + image_size : (position >= image_size ? position - image_size : position);
  };
  return {along(rows_, array.rows, row), along(cols_, array.cols, col)};
}

template <typename Value>
CurveletCoefficients<Value> CurveletTransform::MakeCoefficients() const {
  CurveletCoefficients<Value> result;
  for (int scale = 1; scale <= options_.num_scales; ++scale) {
    auto& arrays = result.scales.emplace_back();
    for (int angle = 1; angle <= NumArrays(scale); ++angle) {
      const ArrayInfo array = Array(scale, angle);
      arrays.emplace_back(array.rows, array.cols);
    }
  }
  return result;
}

template <typename Value>
absl::Status CurveletTransform::CheckCoefficients(const CurveletCoefficients<Value>& curvelets) const {
  if (curvelets.scales.size() != static_cast<std::size_t>(options_.num_scales)) {
    return absl::InvalidArgumentError(
        absl::StrCat("coefficients have ", curvelets.scales.size(), " scales, not ", options_.num_scales));
  }
  for (int scale = 1; scale <= options_.num_scales; ++scale) {
    const std::size_t num_arrays = curvelets.scales[static_cast<std::size_t>(scale) - 1].size();
    if (num_arrays != static_cast<std::size_t>(NumArrays(scale))) {
      return absl::InvalidArgumentError(
          absl::StrCat("scale ", scale, " has ", num_arrays, " arrays, not ", NumArrays(scale)));
    }
    for (int angle = 1; angle <= NumArrays(scale); ++angle) {
      const ArrayInfo array = Array(scale, angle);
      const absl::Status status = CheckImage(ArrayAt(curvelets, scale, angle), array.rows, array.cols);
      if (!status.ok()) {
        return absl::InvalidArgumentError(absl::StrCat("scale ", scale, ", array ", angle, ": ", status.message()));
      }
    }
  }
  return absl::OkStatus();
}

absl::Status CurveletTransform::CheckScale(int scale) const {
  if (scale >= 1 && scale <= options_.num_scales) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("no scale ", scale, "; there are 1 to ", options_.num_scales));
}

absl::StatusOr<RealCurvelets> CurveletTransform::Forward(const Image<double>& image) const {
  if (absl::Status status = CheckImage(image, rows_, cols_); !status.ok()) return status;
  auto curvelets = MakeCoefficients<double>();
  CurveletFrame::Sink sink;
  sink.wavelet = [&](int scale, Image<double> array) { ArrayAt(curvelets, scale, 1) = std::move(array); };
  sink.wedge = [&](const CurveletWedge& wedge, const Complex* array) {
    double* cosines = ArrayAt(curvelets, wedge.scale, wedge.angle).pixels.data();
    double* sines = ArrayAt(curvelets, wedge.scale, wedge.angle + NumArrays(wedge.scale) / 2).pixels.data();
    ForEachCoefficient(wedge, [&](std::size_t natural, std::size_t stored) {
      cosines[stored] = std::numbers::sqrt2 * array[natural].real();
      sines[stored] = std::numbers::sqrt2 * array[natural].imag();
    });
  };
  frame_->Analyse(image, sink);
  return curvelets;
}

// Adds factor times the transform of a real image.
CurveletFrame::Sink CurveletTransform::ComplexSink(ComplexCurvelets& curvelets, Complex factor) const {
  CurveletFrame::Sink sink;
  sink.wavelet = [&curvelets, factor](int scale, const Image<double>& array) {
    Image<Complex>& out = ArrayAt(curvelets, scale, 1);
    for (std::size_t i = 0; i < array.size(); ++i) out.pixels[i] += factor * array.pixels[i];
  };
  sink.wedge = [this, &curvelets, factor](const CurveletWedge& wedge, const Complex* array) {
    Complex* same = ArrayAt(curvelets, wedge.scale, wedge.angle).pixels.data();
    Complex* opposite = ArrayAt(curvelets, wedge.scale, wedge.angle + NumArrays(wedge.scale) / 2).pixels.data();
    ForEachCoefficient(wedge, [&](std::size_t natural, std::size_t stored) {
      same[stored] += factor * array[natural];
      opposite[stored] += factor * std::conj(array[natural]);
    });
  };
  return sink;
}

absl::StatusOr<ComplexCurvelets> CurveletTransform::ForwardComplex(const Image<double>& image) const {
  if (absl::Status status = CheckImage(image, rows_, cols_); !status.ok()) return status;
  auto curvelets = MakeCoefficients<Complex>();
  frame_->Analyse(image, ComplexSink(curvelets, 1.0));
  return curvelets;
}

absl::StatusOr<ComplexCurvelets> CurveletTransform::ForwardComplex(const Image<Complex>& image) const {
  if (absl::Status status = CheckImage(image, rows_, cols_); !status.ok()) return status;
  auto curvelets = MakeCoefficients<Complex>();
  frame_->Analyse(Part(image, false), ComplexSink(curvelets, 1.0));
  frame_->Analyse(Part(image, true), ComplexSink(curvelets, Complex(0.0, 1.0)));
  return curvelets;
}

Image<double> CurveletTransform::Synthesise(const RealCurvelets& curvelets, int first_scale, int last_scale) const {
  CurveletFrame::Source source;
  source.wavelet = [&](int scale) { return ArrayAt(curvelets, scale, 1); };
  source.wedge = [&](const CurveletWedge& wedge, Complex* array) {
    const double* cosines = ArrayAt(curvelets, wedge.scale, wedge.angle).pixels.data();
    const double* sines = ArrayAt(curvelets, wedge.scale, wedge.angle + NumArrays(wedge.scale) / 2).pixels.data();
    ForEachCoefficient(wedge, [&](std::size_t natural, std::size_t stored) {
      array[natural] = (1.0 / std::numbers::sqrt2) * Complex(cosines[stored], sines[stored]);
    });
  };
  return frame_->Synthesise(source, first_scale, last_scale);
}

Image<Complex> CurveletTransform::Synthesise(const ComplexCurvelets& curvelets, int first_scale, int last_scale) const {
  const Image<double> real = frame_->Synthesise(ComplexSource(curvelets, false), first_scale, last_scale);
  const Image<double> imaginary = frame_->Synthesise(ComplexSource(curvelets, true), first_scale, last_scale);
  Image<Complex> result(rows_, cols_);
  for (std::size_t i = 0; i < result.size(); ++i) result.pixels[i] = {real.pixels[i], imaginary.pixels[i]};
  return result;
}

absl::StatusOr<Image<double>> CurveletTransform::Inverse(const RealCurvelets& curvelets) const {
  if (absl::Status status = CheckCoefficients(curvelets); !status.ok()) return status;
  return Synthesise(curvelets, 1, options_.num_scales);
}

absl::StatusOr<Image<Complex>> CurveletTransform::Inverse(const ComplexCurvelets& curvelets) const {
  if (absl::Status status = CheckCoefficients(curvelets); !status.ok()) return status;
  return Synthesise(curvelets, 1, options_.num_scales);
}

absl::StatusOr<Image<double>> CurveletTransform::SingleScale(const RealCurvelets& curvelets, int scale) const {
  if (absl::Status status = CheckScale(scale); !status.ok()) return status;
  if (absl::Status status = CheckCoefficients(curvelets); !status.ok()) return status;
  return Synthesise(curvelets, scale, scale);
}

absl::StatusOr<Image<Complex>> CurveletTransform::SingleScale(const ComplexCurvelets& curvelets, int scale) const {
  if (absl::Status status = CheckScale(scale); !status.ok()) return status;
  if (absl::Status status = CheckCoefficients(curvelets); !status.ok()) return status;
  return Synthesise(curvelets, scale, scale);
}

}  // namespace curvereg
