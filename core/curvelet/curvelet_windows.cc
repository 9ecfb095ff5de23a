// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_windows.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace curvereg {
namespace {

// Arguments closer than this to an end are taken for the end: (integer - integer) / integer lands there by rounding.
constexpr double kEnd = 0x1p-52;

// Decreasing bump on (0, 1); relies on exp(-inf) = 0 and 1 / 0 = inf as x approaches 1.
double Bump(double x) { return std::exp(1.0 - 1.0 / (1.0 - std::exp(1.0 - 1.0 / x))); }

}  // namespace

double FallingStep(double x) {
  if (x <= kEnd) return 1.0;
  if (x >= 1.0) return 0.0;
  const double falling = Bump(x);
  const double rising = Bump(1.0 - x);
  return falling / std::sqrt(falling * falling + rising * rising);
}

double RisingStep(double x) {
  if (x <= kEnd) return 0.0;
  if (x >= 1.0) return 1.0;
  const double falling = Bump(x);
  const double rising = Bump(1.0 - x);
  return rising / std::sqrt(falling * falling + rising * rising);
}

LowPass MakeLowPass(int n, int level) {
  // Integer arithmetic, so that no rounding decides a size: floor(n / (3 * 2^p)) and floor(2n / (3 * 2^p)).
  const int64_t denominator = int64_t{3} << level;
  const int flat = static_cast<int>(n / denominator);
  const int end = static_cast<int>(2 * int64_t{n} / denominator);
  // Level 0 must complement its alias k -> n - k, which for a multiple of 3 needs a transition shorter by one.
  const bool shortened = level == 0 && n % 3 == 0;
  const double width = std::max(end - flat - (shortened ? 2 : 1), 1);
  LowPass result;
  for (int k = 0; k <= end; ++k) {
    const double x = (k - flat - 1) / width;
    const bool is_past = shortened && k == end;
    result.pass.push_back(k <= flat ? 1.0 : (is_past ? 0.0 : FallingStep(x)));
    result.stop.push_back(k <= flat ? 0.0 : (is_past ? 1.0 : RisingStep(x)));
  }
  return result;
}

absl::Status ValidateScales(int rows, int cols, int num_scales) {
  if (rows < 1 || cols < 1) return absl::InvalidArgumentError(absl::StrCat("image is empty: ", rows, " x ", cols));
  if (num_scales < 2) return absl::InvalidArgumentError(absl::StrCat(num_scales, " scales; at least 2 are needed"));
  int max_scales = 0;
  while (std::min(rows, cols) >= std::ldexp(6.0, max_scales)) ++max_scales;
  if (num_scales > max_scales) {
    return absl::InvalidArgumentError(
        absl::StrCat(num_scales, " scales are too many for an image of ", rows, " x ", cols, "; at most ", max_scales));
  }
  return absl::OkStatus();
}

}  // namespace curvereg
