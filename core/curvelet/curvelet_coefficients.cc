// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_coefficients.h"

#include <cmath>
#include <cstddef>

namespace curvereg {
namespace {

template <typename Value, typename Shrink>
void ForEachBeyondCoarsest(CurveletCoefficients<Value>& curvelets, const Shrink& shrink) {
  for (std::size_t j = 1; j < curvelets.scales.size(); ++j) {
    for (Image<Value>& array : curvelets.scales[j]) {
      for (Value& value : array.pixels) value = shrink(value);
    }
  }
}

template <typename Value>
void Hard(double threshold, CurveletCoefficients<Value>& curvelets) {
  ForEachBeyondCoarsest(curvelets, [&](Value value) { return std::abs(value) > threshold ? value : Value(0.0); });
}

template <typename Value>
void Soft(double threshold, CurveletCoefficients<Value>& curvelets) {
  ForEachBeyondCoarsest(curvelets, [&](Value value) {
    const double size = std::abs(value);
    return size > threshold ? value * (1.0 - threshold / size) : Value(0.0);
  });
}

}  // namespace

void HardThreshold(double threshold, RealCurvelets& curvelets) { Hard(threshold, curvelets); }
void HardThreshold(double threshold, ComplexCurvelets& curvelets) { Hard(threshold, curvelets); }
void SoftThreshold(double threshold, RealCurvelets& curvelets) { Soft(threshold, curvelets); }
void SoftThreshold(double threshold, ComplexCurvelets& curvelets) { Soft(threshold, curvelets); }

}  // namespace curvereg
