// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The engine of the curvelet transform: a real image to its wavelet arrays and the arrays of its north and east
// wedges, and back by the adjoint. Those of the opposite wedges are their conjugates; how all are stored as
// coefficients is up to the caller (curvelet_transform.h). A complex image is two real ones.
#ifndef CURVEREG_CORE_CURVELET_CURVELET_FRAME_H_
#define CURVEREG_CORE_CURVELET_CURVELET_FRAME_H_

#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "core/base/image.h"
#include "core/curvelet/curvelet_spectrum.h"
#include "core/curvelet/curvelet_wedges.h"
#include "core/curvelet/fft.h"

namespace curvereg {

// Plans and windows for images of one size. Immutable.
class CurveletFrame {
 public:
  using Complex = std::complex<double>;

  // Takes what Analyse finds. Called from many threads at once, once for each array. Wedge arrays come in natural
  // order (the coefficient at offset m from the origin at index m mod n) and are only lent.
  struct Sink {
    std::function<void(int scale, Image<double> array)> wavelet;
    std::function<void(const CurveletWedge& wedge, const Complex* array)> wedge;
  };
  // Gives what Synthesise asks for, in the same form: `wedge` fills `array`.
  struct Source {
    std::function<Image<double>(int scale)> wavelet;
    std::function<void(const CurveletWedge& wedge, Complex* array)> wedge;
  };

  // Precondition: the options are valid for this size, with num_scales > 0.
  CurveletFrame(int rows, int cols, const CurveletOptions& options);

  // Precondition: the image has this frame's size.
  void Analyse(const Image<double>& image, const Sink& sink) const;

  // The image of scales first_scale .. last_scale, the others taken for zero.
  Image<double> Synthesise(const Source& source, int first_scale, int last_scale) const;

  // Wedge `angle` of a curvelet scale, 1 <= angle <= half their number.
  const CurveletWedge& WedgeAt(int scale, int angle) const;
  int coarsest_rows() const { return coarsest_.rows; }
  int coarsest_cols() const { return coarsest_.cols; }
  bool HasWavelet(int scale) const { return scale == 1 || (scale == options_.num_scales && finest_.rows > 0); }

 private:
  struct Wedge {
    CurveletWedge window;
    std::shared_ptr<const FftPlan<double>> forward;
    std::shared_ptr<const FftPlan<double>> inverse;
  };
  // A wavelet scale: its array's size and its window for k1 >= 0, k2 >= 0 (even in both).
  struct Wavelet {
    Wavelet() = default;
    Wavelet(int num_rows, int num_cols, Image<double> window_values);
    int rows = 0;
    int cols = 0;
    Image<double> window;
    std::shared_ptr<const FftPlan<double>> forward;
    std::shared_ptr<const FftPlan<double>> inverse;
  };

  Image<double> AnalyseCoarsest(const SpectrumBox& box) const;
  Image<double> AnalyseFinest(const Complex* half_spectrum) const;
  void AnalyseWedge(const Wedge& wedge, const SpectrumBox& box, Complex* array) const;
  void SynthesiseCoarsest(const Image<double>& array, Complex* half_spectrum) const;
  void SynthesiseFinest(const Image<double>& array, Complex* half_spectrum) const;
  void SynthesiseScale(int scale, const Source& source, SpectrumBox& box) const;

  int rows_;
  int cols_;
  CurveletOptions options_;
  SpectrumFolding folding_;
  std::shared_ptr<const FftPlan<double>> forward_;
  std::shared_ptr<const FftPlan<double>> inverse_;
  Wavelet coarsest_;
  Wavelet finest_;                          // without rows when the finest scale is curvelets
  std::vector<std::vector<Wedge>> wedges_;  // [scale - 1][angle - 1]; empty for wavelet scales
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_CURVELET_CURVELET_FRAME_H_
