// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The middle of a real image's spectrum on centred frequencies, as the curvelet transform reads and writes it.
//
// X(k1, k2) = (rows * cols)^(-1/2) * sum of f(row, col) * exp(-2 pi i (k1 (row - o1) / rows + k2 (col - o2) / cols)),
// origin o = (floor(rows / 2), floor(cols / 2)), for |k1| <= max_k1, |k2| <= max_k2; X has the periods rows and cols,
// so the box may be larger than they are.
#ifndef CURVEREG_CORE_CURVELET_CURVELET_SPECTRUM_H_
#define CURVEREG_CORE_CURVELET_CURVELET_SPECTRUM_H_

#include <complex>
#include <cstddef>
#include <vector>

#include "core/curvelet/fft.h"

namespace curvereg {

struct SpectrumBox {
  SpectrumBox(int largest_k1, int largest_k2);
  // Address of (k1, 0); k2 in [-max_k2, max_k2] may be added to it.
  std::complex<double>* Row(int k1) { return values.data() + Offset(k1); }
  const std::complex<double>* Row(int k1) const { return values.data() + Offset(k1); }
  std::ptrdiff_t Offset(int k1) const { return std::ptrdiff_t{k1 + max_k1} * (2 * max_k2 + 1) + max_k2; }

  int max_k1;
  int max_k2;
  FftBuffer<std::complex<double>> values;  // uninitialised
};

// Translates between a box and the half spectrum (FftKind::kRealToHalf) of a real image of one size. Immutable.
class SpectrumFolding {
 public:
  // Preconditions: 0 <= max_k1 < rows, 0 <= max_k2 < cols.
  SpectrumFolding(int rows, int cols, int max_k1, int max_k2);

  // The box of the image with this half spectrum, where k2 >= 0 or k1 < 0: the rest is not needed and left undefined.
  SpectrumBox Unfold(const std::complex<double>* half_spectrum) const;

  // The adjoint: adds to the half spectrum what the box holds, entries with equal frequency modulo the periods summed,
  // and each entry's conjugate at the opposite frequency.
  void AddFolded(const SpectrumBox& box, std::complex<double>* half_spectrum) const;

  // Adds `value` at (k1, k2) alone, without the conjugate. Precondition: 0 <= k2 <= cols / 2, |k1| <= max_k1.
  void AddAt(int k1, int k2, std::complex<double> value, std::complex<double>* half_spectrum) const;

 private:
  // One axis of the box: for k = -max_k .. max_k the index k mod n, and what turns the DFT into X.
  struct Axis {
    Axis(int n, int max_k, double scale);
    int n;
    int max_k;
    std::vector<int> index;
    std::vector<std::complex<double>> phase;
    int Index(int k) const { return index[static_cast<std::size_t>(k + max_k)]; }
    std::complex<double> Phase(int k) const { return phase[static_cast<std::size_t>(k + max_k)]; }
  };

  Axis axis1_;
  Axis axis2_;
  int half_cols_;
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_CURVELET_CURVELET_SPECTRUM_H_
