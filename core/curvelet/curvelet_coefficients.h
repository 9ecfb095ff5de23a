// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Curvelet coefficients and their thresholding, which keeps few large coefficients and drops the rest.
#ifndef CURVEREG_CORE_CURVELET_CURVELET_COEFFICIENTS_H_
#define CURVEREG_CORE_CURVELET_CURVELET_COEFFICIENTS_H_

#include <complex>
#include <vector>

#include "core/base/image.h"

namespace curvereg {

// Value is double (real-valued curvelets: cosines in the first half of a scale's arrays, sines in the second) or
// std::complex<double>.
template <typename Value>
struct CurveletCoefficients {
  // scales[j - 1][l - 1]: the array of scale j = 1 (coarsest), 2, ... and wedge l = 1, 2, ...; wavelet scales hold one.
  std::vector<std::vector<Image<Value>>> scales;
};

using RealCurvelets = CurveletCoefficients<double>;
using ComplexCurvelets = CurveletCoefficients<std::complex<double>>;

// Sets to zero the coefficients with |c| <= threshold; scale 1, the image's coarse shape, is left alone.
void HardThreshold(double threshold, RealCurvelets& curvelets);
void HardThreshold(double threshold, ComplexCurvelets& curvelets);

// Draws all coefficients by `threshold` towards zero, c * max(0, 1 - threshold / |c|); scale 1 is left alone.
// Precondition: threshold >= 0.
void SoftThreshold(double threshold, RealCurvelets& curvelets);
void SoftThreshold(double threshold, ComplexCurvelets& curvelets);

}  // namespace curvereg

#endif  // CURVEREG_CORE_CURVELET_CURVELET_COEFFICIENTS_H_
