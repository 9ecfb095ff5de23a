// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/base/parallel.h"
#include "core/curvelet/curvelet_windows.h"

namespace curvereg {
namespace {

using Complex = std::complex<double>;

std::size_t Area(int rows, int cols) { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols); }

int BoxLevel(const CurveletOptions& options) { return options.finest == FinestScale::kCurvelets ? 0 : 1; }

// W_1 = L_(J-1) on its box.
Image<double> CoarsestWindow(int rows, int cols, int level) {
  const LowPass along_rows = MakeLowPass(rows, level);
  const LowPass along_cols = MakeLowPass(cols, level);
  Image<double> window(along_rows.support() + 1, along_cols.support() + 1);
  for (int k1 = 0; k1 < window.rows; ++k1) {
    for (int k2 = 0; k2 < window.cols; ++k2) window(k1, k2) = along_rows.Pass(k1) * along_cols.Pass(k2);
  }
  return window;
}

// W_J = sqrt(1 - L_1^2), by its stable form.
Image<double> FinestWindow(int rows, int cols) {
  const LowPass along_rows = MakeLowPass(rows, 1);
  const LowPass along_cols = MakeLowPass(cols, 1);
  Image<double> window(rows / 2 + 1, cols / 2 + 1);
  for (int k1 = 0; k1 < window.rows; ++k1) {
    for (int k2 = 0; k2 < window.cols; ++k2) {
      const double stop1 = along_rows.Stop(k1);
      const double stop2 = along_rows.Pass(k1) * along_cols.Stop(k2);
      window(k1, k2) = std::sqrt(stop1 * stop1 + stop2 * stop2);
    }
  }
  return window;
}

// out[i] = in[(i + shift) mod n] along both axes.
Image<double> Rolled(const Image<double>& in, int shift_rows, int shift_cols) {
  Image<double> out(in.rows, in.cols);
  for (int row = 0; row < in.rows; ++row) {
    const double* from = in.Row((row + shift_rows) % in.rows);
    std::rotate_copy(from, from + shift_cols, from + in.cols, out.Row(row));
  }
  return out;
}

// Calls visit(box index, array index, weight index, count) for each stretch of a wedge's window on which both indices
// run side by side: a run of frequencies, cut where (k1 mod rows, k2 mod cols) wraps.
template <typename Visit>
void ForEachStretch(const CurveletWedge& wedge, const SpectrumBox& box, const Visit& visit) {
  for (const CurveletWedge::Run& run : wedge.runs) {
    const int row = (run.k1 % wedge.rows + wedge.rows) % wedge.rows;
    int col = (run.k2 % wedge.cols + wedge.cols) % wedge.cols;
    for (int done = 0; done < run.size;) {
      const int count = std::min(run.size - done, wedge.cols - col);
      visit(box.Offset(run.k1) + run.k2 + done, std::ptrdiff_t{row} * wedge.cols + col,
            static_cast<std::ptrdiff_t>(run.first_weight) + done, count);
      done += count;
      col = 0;
    }
  }
}

}  // namespace

CurveletFrame::Wavelet::Wavelet(int num_rows, int num_cols, Image<double> window_values)
    : rows(num_rows),
      cols(num_cols),
      window(std::move(window_values)),
      forward(GetFftPlan<double>({rows, cols}, FftKind::kRealToHalf)),
      inverse(GetFftPlan<double>({rows, cols}, FftKind::kHalfToReal)) {}

CurveletFrame::CurveletFrame(int rows, int cols, const CurveletOptions& options)
    : rows_(rows),
      cols_(cols),
      options_(options),
      folding_(rows, cols, LevelExtent(rows, BoxLevel(options)), LevelExtent(cols, BoxLevel(options))),
      forward_(GetFftPlan<double>({rows, cols}, FftKind::kRealToHalf)),
      inverse_(GetFftPlan<double>({rows, cols}, FftKind::kHalfToReal)),
      wedges_(static_cast<std::size_t>(options.num_scales)) {
  Image<double> window = CoarsestWindow(rows, cols, options.num_scales - 1);
  coarsest_ = Wavelet(2 * window.rows - 1, 2 * window.cols - 1, std::move(window));
  if (options.finest == FinestScale::kWavelets) finest_ = Wavelet(rows, cols, FinestWindow(rows, cols));
  for (int scale = 2; scale <= options.num_scales; ++scale) {
    if (HasWavelet(scale)) continue;
    for (CurveletWedge& wedge : MakeWedges(rows, cols, scale, options)) {
      const FftShape shape{wedge.rows, wedge.cols};
      wedges_[static_cast<std::size_t>(scale) - 1].push_back({std::move(wedge),
                                                              GetFftPlan<double>(shape, FftKind::kForward),
                                                              GetFftPlan<double>(shape, FftKind::kInverse)});
    }
  }
}

const CurveletWedge& CurveletFrame::WedgeAt(int scale, int angle) const {
  return wedges_[static_cast<std::size_t>(scale) - 1][static_cast<std::size_t>(angle) - 1].window;
}

void CurveletFrame::Analyse(const Image<double>& image, const Sink& sink) const {
  FftBuffer<Complex> half_spectrum(Area(rows_, cols_ / 2 + 1));
  forward_->Execute(image.pixels.data(), half_spectrum.data());
  const SpectrumBox box = folding_.Unfold(half_spectrum.data());
  std::vector<const Wedge*> wedges;  // large ones first: they balance the threads best
  std::size_t largest = 0;
  for (auto scale = wedges_.rbegin(); scale != wedges_.rend(); ++scale) {
    for (const Wedge& wedge : *scale) {
      wedges.push_back(&wedge);
      largest = std::max(largest, Area(wedge.window.rows, wedge.window.cols));
    }
  }
  FftBufferPool<Complex> arrays(largest);
  ParallelFor(2 + static_cast<int>(wedges.size()), [&](int task) {
    if (task == 0 && finest_.rows > 0) sink.wavelet(options_.num_scales, AnalyseFinest(half_spectrum.data()));
    if (task == 1) sink.wavelet(1, AnalyseCoarsest(box));
    if (task < 2) return;
    const Wedge& wedge = *wedges[static_cast<std::size_t>(task) - 2];
    FftBuffer<Complex> array = arrays.Take();
    AnalyseWedge(wedge, box, array.data());
    sink.wedge(wedge.window, array.data());
    arrays.Give(std::move(array));
  });
}

void CurveletFrame::AnalyseWedge(const Wedge& wedge, const SpectrumBox& box, Complex* array) const {
  const std::size_t size = Area(wedge.window.rows, wedge.window.cols);
  std::fill_n(array, size, Complex(0.0));
  // The unitary inverse DFT's factor.
  const double scale = 1.0 / std::sqrt(static_cast<double>(size));
  const Complex* spectrum = box.values.data();
  const double* weights = wedge.window.weights.data();
  ForEachStretch(wedge.window, box, [&](std::ptrdiff_t from, std::ptrdiff_t to, std::ptrdiff_t weight, int count) {
    for (int i = 0; i < count; ++i) array[to + i] += spectrum[from + i] * (weights[weight + i] * scale);
  });
  wedge.inverse->Execute(array);
}

Image<double> CurveletFrame::AnalyseCoarsest(const SpectrumBox& box) const {
  const int half_cols = coarsest_.window.cols;  // the array's width is odd
  FftBuffer<Complex> half(Area(coarsest_.rows, half_cols));
  const double scale = 1.0 / std::sqrt(static_cast<double>(Area(coarsest_.rows, coarsest_.cols)));
  for (int row = 0; row < coarsest_.rows; ++row) {
    const int k1 = row < coarsest_.window.rows ? row : row - coarsest_.rows;
    const double* window = coarsest_.window.Row(std::abs(k1));
    const Complex* in = box.Row(k1);
    Complex* out = half.data() + std::ptrdiff_t{row} * half_cols;
    for (int k2 = 0; k2 < half_cols; ++k2) out[k2] = in[k2] * (window[k2] * scale);
  }
  Image<double> natural(coarsest_.rows, coarsest_.cols);
  coarsest_.inverse->Execute(half.data(), natural.pixels.data());
  // Offset 0 is stored in the middle, at index floor(n / 2).
  return Rolled(natural, (coarsest_.rows + 1) / 2, (coarsest_.cols + 1) / 2);
}

// Image and array have the same size and origin, so that the origin's phases cancel.
Image<double> CurveletFrame::AnalyseFinest(const Complex* half_spectrum) const {
  const int half_cols = cols_ / 2 + 1;
  FftBuffer<Complex> half(Area(rows_, half_cols));
  const double scale = 1.0 / (static_cast<double>(rows_) * cols_);
  for (int row = 0; row < rows_; ++row) {
    const double* window = finest_.window.Row(std::min(row, rows_ - row));
    const Complex* in = half_spectrum + std::ptrdiff_t{row} * half_cols;
    Complex* out = half.data() + std::ptrdiff_t{row} * half_cols;
    for (int k2 = 0; k2 < half_cols; ++k2) out[k2] = in[k2] * (window[k2] * scale);
  }
  Image<double> result(rows_, cols_);
  finest_.inverse->Execute(half.data(), result.pixels.data());
  return result;
}

Image<double> CurveletFrame::Synthesise(const Source& source, int first_scale, int last_scale) const {
  FftBuffer<Complex> half_spectrum(Area(rows_, cols_ / 2 + 1));
  std::fill_n(half_spectrum.data(), half_spectrum.size(), Complex(0.0));
  SpectrumBox box(LevelExtent(rows_, BoxLevel(options_)), LevelExtent(cols_, BoxLevel(options_)));
  std::fill_n(box.values.data(), box.values.size(), Complex(0.0));
  for (int scale = first_scale; scale <= last_scale; ++scale) {
    if (scale == 1) {
      SynthesiseCoarsest(source.wavelet(scale), half_spectrum.data());
    } else if (HasWavelet(scale)) {
      SynthesiseFinest(source.wavelet(scale), half_spectrum.data());
    } else {
      SynthesiseScale(scale, source, box);
    }
  }
  folding_.AddFolded(box, half_spectrum.data());
  Image<double> result(rows_, cols_);
  inverse_->Execute(half_spectrum.data(), result.pixels.data());
  return result;
}

// FFTs in parallel, then the sums one after another: wedges overlap, and the order of a sum decides its last bits.
void CurveletFrame::SynthesiseScale(int scale, const Source& source, SpectrumBox& box) const {
  const std::vector<Wedge>& wedges = wedges_[static_cast<std::size_t>(scale) - 1];
  std::vector<FftBuffer<Complex>> arrays(wedges.size());
  ParallelFor(static_cast<int>(wedges.size()), [&](int i) {
    const Wedge& wedge = wedges[static_cast<std::size_t>(i)];
    FftBuffer<Complex> array(Area(wedge.window.rows, wedge.window.cols));
    source.wedge(wedge.window, array.data());
    wedge.forward->Execute(array.data());
    arrays[static_cast<std::size_t>(i)] = std::move(array);
  });
  for (std::size_t i = 0; i < wedges.size(); ++i) {
    const CurveletWedge& window = wedges[i].window;
    const double unitary = 1.0 / std::sqrt(static_cast<double>(Area(window.rows, window.cols)));
    const Complex* array = arrays[i].data();
    const double* weights = window.weights.data();
    Complex* spectrum = box.values.data();
    ForEachStretch(window, box, [&](std::ptrdiff_t to, std::ptrdiff_t from, std::ptrdiff_t weight, int count) {
      for (int k = 0; k < count; ++k) spectrum[to + k] += array[from + k] * (weights[weight + k] * unitary);
    });
  }
}

void CurveletFrame::SynthesiseCoarsest(const Image<double>& array, Complex* half_spectrum) const {
  const Image<double> natural = Rolled(array, coarsest_.rows / 2, coarsest_.cols / 2);
  const int half_cols = coarsest_.window.cols;
  FftBuffer<Complex> half(Area(coarsest_.rows, half_cols));
  coarsest_.forward->Execute(natural.pixels.data(), half.data());
  // 1 / sqrt(coarsest size) makes the DFT unitary; the phases of AddAt bring 1 / sqrt(image size) for the way back.
  const double scale = 1.0 / std::sqrt(static_cast<double>(Area(coarsest_.rows, coarsest_.cols)));
  for (int row = 0; row < coarsest_.rows; ++row) {
    const int k1 = row < coarsest_.window.rows ? row : row - coarsest_.rows;
    const double* window = coarsest_.window.Row(std::abs(k1));
    const Complex* in = half.data() + std::ptrdiff_t{row} * half_cols;
    for (int k2 = 0; k2 < half_cols; ++k2) folding_.AddAt(k1, k2, in[k2] * (window[k2] * scale), half_spectrum);
  }
}

void CurveletFrame::SynthesiseFinest(const Image<double>& array, Complex* half_spectrum) const {
  const int half_cols = cols_ / 2 + 1;
  FftBuffer<Complex> half(Area(rows_, half_cols));
  finest_.forward->Execute(array.pixels.data(), half.data());
  const double scale = 1.0 / (static_cast<double>(rows_) * cols_);
  for (int row = 0; row < rows_; ++row) {
    const double* window = finest_.window.Row(std::min(row, rows_ - row));
    const Complex* in = half.data() + std::ptrdiff_t{row} * half_cols;
    Complex* out = half_spectrum + std::ptrdiff_t{row} * half_cols;
    for (int k2 = 0; k2 < half_cols; ++k2) out[k2] += in[k2] * (window[k2] * scale);
  }
}

}  // namespace curvereg
