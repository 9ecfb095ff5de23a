// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/scale_bands.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/parallel.h"
#include "core/curvelet/curvelet_windows.h"

namespace curvereg {
namespace {

int LastScale(const ScaleBandOptions& options) {
  return options.last_scale == 0 ? options.num_scales : options.last_scale;
}

absl::Status Validate(int rows, int cols, const ScaleBandOptions& options) {
  if (absl::Status status = ValidateScales(rows, cols, options.num_scales); !status.ok()) return status;
  const int last_scale = LastScale(options);
  if (options.first_scale < 1 || options.first_scale > last_scale || last_scale > options.num_scales) {
    return absl::InvalidArgumentError(absl::StrCat("scales ", options.first_scale, " to ", last_scale,
                                                   " are no range within 1 to ", options.num_scales));
  }
  return absl::OkStatus();
}

// Number of frequencies 0, 1, ... of an axis of n samples that the low-pass of `level` keeps; at most n / 2 + 1.
int Extent(int n, int level) {
  return std::min(n / 2 + 1, static_cast<int>(2 * int64_t{n} / (int64_t{3} << level)) + 1);
}

// The squared low-pass L_p^2 of one level on 0 <= k1 < extent, 0 <= k2 < extent; even in both, zero beyond.
Image<double> CartesianLowPass(int rows, int cols, int level) {
  const LowPass along_rows = MakeLowPass(rows, level);
  const LowPass along_cols = MakeLowPass(cols, level);
  Image<double> result(Extent(rows, level), Extent(cols, level));
  for (int k1 = 0; k1 < result.rows; ++k1) {
    for (int k2 = 0; k2 < result.cols; ++k2) {
      const double pass = along_rows.Pass(k1) * along_cols.Pass(k2);
      result(k1, k2) = pass * pass;
    }
  }
  return result;
}

Image<double> PolarLowPass(int rows, int cols, int level) {
  const double inner_radius = std::ldexp(1.0 / 3.0, -level);  // of the transition, which ends at twice of it
  Image<double> result(Extent(rows, level), Extent(cols, level));
  for (int k1 = 0; k1 < result.rows; ++k1) {
    for (int k2 = 0; k2 < result.cols; ++k2) {
      const double u = static_cast<double>(k1) / rows;
      const double v = static_cast<double>(k2) / cols;
      const double pass = FallingStep((std::sqrt(u * u + v * v) - inner_radius) / inner_radius);
      result(k1, k2) = pass * pass;
    }
  }
  return result;
}

Image<double> SquaredLowPass(int rows, int cols, int level, WindowShape windows) {
  return windows == WindowShape::kCartesian ? CartesianLowPass(rows, cols, level) : PolarLowPass(rows, cols, level);
}

}  // namespace

template <typename T>
ScaleBands<T>::ScaleBands(int rows, int cols)
    : rows_(rows),
      cols_(cols),
      forward_(GetFftPlan<T>({rows, cols}, FftKind::kRealToHalf)),
      inverse_rows_(GetFftPlan<T>({rows, cols}, FftKind::kHalfRowsToReal)) {}

template <typename T>
absl::StatusOr<ScaleBands<T>> ScaleBands<T>::Create(int rows, int cols, const ScaleBandOptions& options) {
  if (absl::Status status = Validate(rows, cols, options); !status.ok()) return status;
  const int num_bands = LastScale(options) - options.first_scale + 1;
  // Band i lies between low-pass i and low-pass i + 1: H_j = L_(J-j)^2 - L_(J-j+1)^2, from zero and up to one.
  std::vector<Image<double>> low_passes(static_cast<std::size_t>(num_bands) + 1);
  ParallelFor(num_bands + 1, [&](int i) {
    const int level = options.num_scales - options.first_scale - i + 1;
    Image<double>& low_pass = low_passes[static_cast<std::size_t>(i)];
    if (level == 0) low_pass = Image<double>(rows / 2 + 1, cols / 2 + 1, 1.0);
    if (level > 0 && level < options.num_scales) low_pass = SquaredLowPass(rows, cols, level, options.windows);
  });
  ScaleBands result(rows, cols);
  for (std::size_t i = 0; i + 1 < low_passes.size(); ++i) {
    result.bands_.push_back(result.MakeBand(low_passes[i + 1], low_passes[i]));
  }
  return result;
}

template <typename T>
typename ScaleBands<T>::Band ScaleBands<T>::MakeBand(const Image<double>& outer, const Image<double>& inner) const {
  const double normalisation = 1.0 / (static_cast<double>(rows_) * cols_);
  Band band{.active_rows = outer.rows, .active_cols = outer.cols, .multiplier = {}, .inverse_columns = nullptr};
  band.multiplier.reserve(outer.size());
  for (int k1 = 0; k1 < outer.rows; ++k1) {
    for (int k2 = 0; k2 < outer.cols; ++k2) {
      const double lower = inner.Contains(k1, k2) ? inner(k1, k2) : 0.0;
      band.multiplier.push_back(static_cast<T>(normalisation * (outer(k1, k2) - lower)));
    }
  }
  band.inverse_columns = GetFftPlan<T>({rows_, cols_, band.active_cols}, FftKind::kInverseColumns);
  return band;
}

template <typename T>
absl::StatusOr<std::vector<Image<T>>> ScaleBands<T>::Compute(const Image<T>& image) const {
  if (image.rows != rows_ || image.cols != cols_ || image.size() != image.Index(rows_, 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("image is ", image.rows, " x ", image.cols, ", not ", rows_, " x ", cols_));
  }
  FftBuffer<std::complex<T>> spectrum(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_ / 2 + 1));
  forward_->Execute(image.pixels.data(), spectrum.data());
  FftBufferPool<std::complex<T>> scratch_pool(spectrum.size());
  std::vector<Image<T>> result(bands_.size());
  ParallelFor(static_cast<int>(bands_.size()), [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    FftBuffer<std::complex<T>> scratch = scratch_pool.Take();
    result[index] = ComputeBand(bands_[index], spectrum.data(), scratch.data());
    scratch_pool.Give(std::move(scratch));
  });
  return result;
}

template <typename T>
Image<T> ScaleBands<T>::ComputeBand(const Band& band, const std::complex<T>* spectrum, std::complex<T>* scratch) const {
  const int half_cols = cols_ / 2 + 1;
  for (int row = 0; row < rows_; ++row) {
    const int k1 = std::min(row, rows_ - row);
    const std::complex<T>* in = spectrum + static_cast<std::ptrdiff_t>(row) * half_cols;
    std::complex<T>* out = scratch + static_cast<std::ptrdiff_t>(row) * half_cols;
    const int num_active = k1 < band.active_rows ? band.active_cols : 0;
    const T* multiplier = band.multiplier.data() + static_cast<std::ptrdiff_t>(k1) * band.active_cols;
    for (int k2 = 0; k2 < num_active; ++k2) out[k2] = in[k2] * multiplier[k2];
    std::fill(out + num_active, out + half_cols, std::complex<T>(0));
  }
  band.inverse_columns->Execute(scratch);
  Image<T> result(rows_, cols_);
  inverse_rows_->Execute(scratch, result.pixels.data());
  return result;
}

template class ScaleBands<float>;
template class ScaleBands<double>;

namespace {

template <typename T>
absl::StatusOr<std::vector<Image<T>>> ComputeOnce(const Image<T>& image, const ScaleBandOptions& options) {
  const absl::StatusOr<ScaleBands<T>> bands = ScaleBands<T>::Create(image.rows, image.cols, options);
  if (!bands.ok()) return bands.status();
  return bands->Compute(image);
}

}  // namespace

absl::StatusOr<std::vector<Image<float>>> ComputeScaleBands(const Image<float>& image,
                                                            const ScaleBandOptions& options) {
  return ComputeOnce(image, options);
}

absl::StatusOr<std::vector<Image<double>>> ComputeScaleBands(const Image<double>& image,
                                                             const ScaleBandOptions& options) {
  return ComputeOnce(image, options);
}

}  // namespace curvereg
