// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The fast discrete curvelet transform by wrapping [FDCT], with Matlab-style windows (core/README.md): an image as a
// sum of waves that are local in place, scale and direction. A tight frame: the coefficients hold the image's energy,
// the inverse is the adjoint and reconstructs to rounding (1e-15 of the largest pixel). Periodic in both axes. Any
// size, odd ones too.
//
// Coefficients form one array per wedge, a grid of places (CoefficientPosition). All is unitary: white noise of
// standard deviation sigma gives coefficients of standard deviation below sigma.
//
// Cost: one real FFT of the image, one of its size back for finest wavelets, and one small complex FFT for each pair
// of opposite wedges. Redundancy 2.6 to 2.9 (finest wavelets) or 7.2 to 7.7 (finest curvelets). Deterministic; wedges
// run in parallel (core/base/parallel.h).
#ifndef CURVEREG_CORE_CURVELET_CURVELET_TRANSFORM_H_
#define CURVEREG_CORE_CURVELET_CURVELET_TRANSFORM_H_

#include <complex>
#include <memory>

#include "absl/status/statusor.h"
#include "core/base/image.h"
#include "core/curvelet/curvelet_coefficients.h"
#include "core/curvelet/curvelet_frame.h"
#include "core/curvelet/curvelet_wedges.h"

namespace curvereg {

// Plans and windows for images of one size. Immutable; copies share them, threads may too.
class CurveletTransform {
 public:
  using Complex = std::complex<double>;

  // INVALID_ARGUMENT: see ValidateCurveletOptions.
  static absl::StatusOr<CurveletTransform> Create(int rows, int cols, const CurveletOptions& options = {});

  // Real-valued curvelets: of the n arrays of a scale the first n/2 hold cosines, the others the sines, each sqrt(2)
  // times the real or imaginary part of the complex curvelet. INVALID_ARGUMENT: the image has another size than
  // Create's. Pixels that are not finite spread everywhere.
  absl::StatusOr<RealCurvelets> Forward(const Image<double>& image) const;
  // Complex curvelets; those of a real image have in array l + n/2 the conjugate of array l. Errors as above.
  absl::StatusOr<ComplexCurvelets> ForwardComplex(const Image<double>& image) const;
  absl::StatusOr<ComplexCurvelets> ForwardComplex(const Image<Complex>& image) const;

  // INVALID_ARGUMENT: number or sizes of the arrays are not those of this transform.
  absl::StatusOr<Image<double>> Inverse(const RealCurvelets& curvelets) const;
  absl::StatusOr<Image<Complex>> Inverse(const ComplexCurvelets& curvelets) const;

  // The inverse with all scales but `scale` (1 = coarsest) taken for zero: I_c(scale). Of untouched coefficients
  // ComputeScaleBands with WindowShape::kCartesian gives the same at a fraction of the cost.
  // INVALID_ARGUMENT: as above, or there is no such scale.
  absl::StatusOr<Image<double>> SingleScale(const RealCurvelets& curvelets, int scale) const;
  absl::StatusOr<Image<Complex>> SingleScale(const ComplexCurvelets& curvelets, int scale) const;

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  const CurveletOptions& options() const { return options_; }  // with num_scales filled in
  int NumArrays(int scale) const { return NumAngles(scale, options_); }

  struct ArrayInfo {
    int rows = 0;
    int cols = 0;
    double centre_k1 = 0.0;  // centre frequency, cycles per image downwards and to the right; 0 for wavelets
    double centre_k2 = 0.0;
  };
  // Of array `angle` of `scale`, both from 1. Precondition, here and below: it exists.
  ArrayInfo Array(int scale, int angle) const;

  // Where coefficient (row, col) of that array sits: pixel of the image, row in [0, rows()), col in [0, cols()).
  struct Position {
    double row = 0.0;
    double col = 0.0;
  };
  Position CoefficientPosition(int scale, int angle, int row, int col) const;

 private:
  CurveletTransform(int rows, int cols, const CurveletOptions& options);
  template <typename Value>
  CurveletCoefficients<Value> MakeCoefficients() const;
  template <typename Value>
  absl::Status CheckCoefficients(const CurveletCoefficients<Value>& curvelets) const;
  absl::Status CheckScale(int scale) const;
  CurveletFrame::Sink ComplexSink(ComplexCurvelets& curvelets, Complex factor) const;
  Image<double> Synthesise(const RealCurvelets& curvelets, int first_scale, int last_scale) const;
  Image<Complex> Synthesise(const ComplexCurvelets& curvelets, int first_scale, int last_scale) const;

  int rows_;
  int cols_;
  CurveletOptions options_;
  std::shared_ptr<const CurveletFrame> frame_;
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_CURVELET_CURVELET_TRANSFORM_H_
