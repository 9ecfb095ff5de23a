// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The smooth windows on the frequency plane that curvelet scales are cut with [FDCT, section 3].
// Frequencies are integers k, cycles per image; level p = 0, 1, ... halves the pass-band with each step.
#ifndef CURVEREG_CORE_CURVELET_CURVELET_WINDOWS_H_
#define CURVEREG_CORE_CURVELET_CURVELET_WINDOWS_H_

#include <vector>

#include "absl/status/status.h"

namespace curvereg {

// The falling half window: 1 for x <= 0, 0 for x >= 1, infinitely smooth between, and
// FallingStep(x)^2 + FallingStep(1 - x)^2 = 1 to rounding. Monotone; never NaN for finite x.
double FallingStep(double x);

// Its rising mirror, FallingStep(1 - x) without the rounding of 1 - x near x = 0.
double RisingStep(double x);

// One-dimensional low-pass of level p on an axis of n samples and its power complement, for |k| = 0 .. support.
struct LowPass {
  std::vector<double> pass;  // lambda_p(|k|), exactly 1 up to about n / (3 * 2^p), exactly 0 from 2n / (3 * 2^p) on
  std::vector<double> stop;  // sqrt(1 - lambda_p^2), free of cancellation
  int support() const { return static_cast<int>(pass.size()) - 1; }
  double Pass(int k) const { return k <= support() ? pass[static_cast<std::size_t>(k)] : 0.0; }  // k >= 0
  double Stop(int k) const { return k <= support() ? stop[static_cast<std::size_t>(k)] : 1.0; }
};

// Preconditions: n >= 1, 0 <= level < 30. Level 0 satisfies pass(k)^2 + pass(n - k)^2 = 1 for every n.
LowPass MakeLowPass(int n, int level);

// OK, or INVALID_ARGUMENT: rows or cols < 1, fewer than two scales, or so many that the coarsest low-pass is narrower
// than two samples, min(rows, cols) / (3 * 2^(num_scales - 1)) < 2; below it the windows degenerate.
absl::Status ValidateScales(int rows, int cols, int num_scales);

}  // namespace curvereg

#endif  // CURVEREG_CORE_CURVELET_CURVELET_WINDOWS_H_
