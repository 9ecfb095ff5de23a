// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The images of single curvelet scales, I_c(j), without wedges: band j of an image is its spectrum times a fixed real
// multiplier H_j, because the wedges of a tight frame sum up to the scale window's square [FDCT, section 6].
// Scale 1 is the coarsest. The bands of all scales add up to the image.
//
// Cost: one real FFT, and per band one multiplication and one inverse real FFT that skips the columns which the band
// leaves empty. Single precision is accurate to about 1e-6 of the image's largest value, double to 1e-15.
// Deterministic; bands run in parallel (core/base/parallel.h).
#ifndef CURVEREG_CORE_CURVELET_SCALE_BANDS_H_
#define CURVEREG_CORE_CURVELET_SCALE_BANDS_H_

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/image.h"
#include "core/curvelet/fft.h"

namespace curvereg {

enum class WindowShape {
  kCartesian,  // square coronae: exactly the single scales of the curvelet transform
  kPolar,      // round coronae, the same step on rho = sqrt((k1/rows)^2 + (k2/cols)^2): no direction is preferred
};

struct ScaleBandOptions {
  // Scales of the decomposition. Band j < num_scales keeps wavelengths of about 1.5 to 6 times 2^(num_scales - j)
  // pixels. Default: what fits a 256 x 256 image with room to spare.
  int num_scales = 6;
  // Default kPolar: key points of turned images repeat markedly better.
  WindowShape windows = WindowShape::kPolar;
  int first_scale = 1;  // bands first_scale .. last_scale are computed, in [1, num_scales]
  int last_scale = 0;   // 0: num_scales
};

// Plans and multipliers for images of one size. T is float or double. Immutable; share it between threads.
template <typename T>
class ScaleBands {
 public:
  // INVALID_ARGUMENT: empty image, first_scale .. last_scale not a range within 1 .. num_scales, or num_scales < 2 or
  // so large that the coarsest band is degenerate (see ValidateScales).
  static absl::StatusOr<ScaleBands> Create(int rows, int cols, const ScaleBandOptions& options);

  // Bands first_scale .. last_scale in order, each of the image's size. INVALID_ARGUMENT: another size than Create's.
  // Pixels that are not finite spread over the whole result.
  absl::StatusOr<std::vector<Image<T>>> Compute(const Image<T>& image) const;

 private:
  // H_j / (rows * cols) on k1 = 0 .. active_rows - 1, k2 = 0 .. active_cols - 1; even in k1, zero elsewhere.
  struct Band {
    int active_rows = 0;
    int active_cols = 0;
    std::vector<T> multiplier;
    std::shared_ptr<const FftPlan<T>> inverse_columns;
  };

  ScaleBands(int rows, int cols);
  // The band between two squared low-passes, given for frequencies 0, 1, ... of both axes.
  Band MakeBand(const Image<double>& outer, const Image<double>& inner) const;
  // `scratch` holds a half spectrum; what it held before does not matter.
  Image<T> ComputeBand(const Band& band, const std::complex<T>* spectrum, std::complex<T>* scratch) const;

  int rows_;
  int cols_;
  std::vector<Band> bands_;
  std::shared_ptr<const FftPlan<T>> forward_;
  std::shared_ptr<const FftPlan<T>> inverse_rows_;
};

// The one-off form of the above: makes the multipliers, which costs about half as much as the bands.
absl::StatusOr<std::vector<Image<float>>> ComputeScaleBands(const Image<float>& image, const ScaleBandOptions& options);
absl::StatusOr<std::vector<Image<double>>> ComputeScaleBands(const Image<double>& image,
                                                             const ScaleBandOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_CORE_CURVELET_SCALE_BANDS_H_
