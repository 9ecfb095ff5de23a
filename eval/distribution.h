// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Empirical distributions of errors and run times: quantiles and the cumulative distribution function.
#ifndef CURVEREG_EVAL_DISTRIBUTION_H_
#define CURVEREG_EVAL_DISTRIBUTION_H_

#include <span>
#include <vector>

namespace curvereg {

// The p-quantile, p in [0, 1] (clamped), by linear interpolation between order statistics: p = 0 is the smallest value,
// 0.5 the median, 1 the largest. NaN when `values` is empty. Values that are not finite are left out.
double Quantile(std::span<const double> values, double p);

// Root of the mean square of the finite values; NaN when there are none.
double RootMeanSquare(std::span<const double> values);

struct DistributionStep {
  double value = 0.0;
  double share = 0.0;  // of all `total` values, those <= value, in (0, 1]
};

// The steps of the empirical cumulative distribution function, one per distinct finite value, ascending. Values that
// are not finite count in `total` only, so the last share is below 1 when some are missing.
// Precondition: total >= values.size().
std::vector<DistributionStep> EmpiricalDistribution(std::span<const double> values, int total);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_DISTRIBUTION_H_
