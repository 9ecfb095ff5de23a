// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scale_bands.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "absl/strings/str_cat.h"
#include "core/curvelet_windows.h"
#include "core/parallel.h"

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

// The squared low-pass L_p^2 of one shape, on |k1| <= rows/2 and 0 <= k2 <= cols/2.
class SquaredLowPass {
 public:
  SquaredLowPass(int rows, int cols, int level, WindowShape shape)
      : rows_(rows), cols_(cols), inner_radius_(std::ldexp(1.0 / 3.0, -level)), shape_(shape) {
    if (shape == WindowShape::kCartesian) {
      along_rows_ = MakeLowPass(rows, level);
      along_cols_ = MakeLowPass(cols, level);
    }
  }

  // Number of frequencies 0, 1, ... of an axis of n samples before the pass-band ends; at most n / 2 + 1.
  int Extent(int n) const { return std::min(n / 2 + 1, static_cast<int>(std::floor(2.0 * inner_radius_ * n)) + 1); }

  double operator()(int k1, int k2) const {
    if (shape_ == WindowShape::kCartesian) {
      const double pass = along_rows_.Pass(k1) * along_cols_.Pass(k2);
      return pass * pass;
    }
    const double u = static_cast<double>(k1) / rows_;
    const double v = static_cast<double>(k2) / cols_;
    const double rho = std::sqrt(u * u + v * v);
    const double pass = FallingStep((rho - inner_radius_) / inner_radius_);
    return pass * pass;
  }

 private:
  int rows_;
  int cols_;
  double inner_radius_;  // of the transition, which ends at twice of it [cycles per pixel]
  WindowShape shape_;
  LowPass along_rows_;
  LowPass along_cols_;
};

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
  ScaleBands result(rows, cols);
  result.bands_.resize(static_cast<std::size_t>(LastScale(options) - options.first_scale + 1));
  ParallelFor(static_cast<int>(result.bands_.size()), [&](int i) {
    result.bands_[static_cast<std::size_t>(i)] = MakeBand(rows, cols, options.first_scale + i, options);
  });
  return result;
}

template <typename T>
typename ScaleBands<T>::Band ScaleBands<T>::MakeBand(int rows, int cols, int scale, const ScaleBandOptions& options) {
  const bool is_finest = scale == options.num_scales;
  // H_1 = L_(J-1)^2, H_j = L_(J-j)^2 - L_(J-j+1)^2, H_J = 1 - L_1^2.
  const int level = options.num_scales - scale;
  const SquaredLowPass outer(rows, cols, level, options.windows);
  const SquaredLowPass inner(rows, cols, level + 1, options.windows);
  Band band;
  band.active_rows = is_finest ? rows / 2 + 1 : outer.Extent(rows);
  band.active_cols = is_finest ? cols / 2 + 1 : outer.Extent(cols);
  const double normalisation = 1.0 / (static_cast<double>(rows) * cols);
  band.multiplier.reserve(static_cast<std::size_t>(band.active_rows) * static_cast<std::size_t>(band.active_cols));
  for (int k1 = 0; k1 < band.active_rows; ++k1) {
    for (int k2 = 0; k2 < band.active_cols; ++k2) {
      const double upper = is_finest ? 1.0 : outer(k1, k2);
      const double lower = scale == 1 || upper == 0.0 ? 0.0 : inner(k1, k2);
      band.multiplier.push_back(static_cast<T>(normalisation * (upper - lower)));
    }
  }
  band.inverse_columns = GetFftPlan<T>({rows, cols, band.active_cols}, FftKind::kInverseColumns);
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
  std::vector<Image<T>> result(bands_.size());
  ParallelFor(static_cast<int>(bands_.size()), [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    result[index] = ComputeBand(bands_[index], spectrum.data());
  });
  return result;
}

template <typename T>
Image<T> ScaleBands<T>::ComputeBand(const Band& band, const std::complex<T>* spectrum) const {
  const int half_cols = cols_ / 2 + 1;
  FftBuffer<std::complex<T>> filtered(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(half_cols));
  for (int row = 0; row < rows_; ++row) {
    const int k1 = std::min(row, rows_ - row);
    const std::complex<T>* in = spectrum + static_cast<std::ptrdiff_t>(row) * half_cols;
    std::complex<T>* out = filtered.data() + static_cast<std::ptrdiff_t>(row) * half_cols;
    const int num_active = k1 < band.active_rows ? band.active_cols : 0;
    const T* multiplier = band.multiplier.data() + static_cast<std::ptrdiff_t>(k1) * band.active_cols;
    for (int k2 = 0; k2 < num_active; ++k2) out[k2] = in[k2] * multiplier[k2];
    std::fill(out + num_active, out + half_cols, std::complex<T>(0));
  }
  band.inverse_columns->Execute(filtered.data());
  Image<T> result(rows_, cols_);
  inverse_rows_->Execute(filtered.data(), result.pixels.data());
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
