// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_spectrum.h"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace curvereg {
namespace {

using Complex = std::complex<double>;

// a * b without the checks for infinities that the language asks of operator*.
Complex Times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace

SpectrumBox::SpectrumBox(int largest_k1, int largest_k2)
    : max_k1(largest_k1),
      max_k2(largest_k2),
      values(static_cast<std::size_t>(2 * largest_k1 + 1) * static_cast<std::size_t>(2 * largest_k2 + 1)) {}

SpectrumFolding::Axis::Axis(int axis_size, int largest_k, double scale) : n(axis_size), max_k(largest_k) {
  for (int k = -max_k; k <= max_k; ++k) {
    index.push_back((k + n) % n);
    // exp(2 pi i k o / n) with the turns reduced in integers; real and exact for even n.
    const int64_t turns = int64_t{index.back()} * (n / 2) % n;
    phase.push_back(2 * turns == n ? Complex(-scale)
                                   : std::polar(scale, 2.0 * std::numbers::pi * static_cast<double>(turns) / n));
  }
}

SpectrumFolding::SpectrumFolding(int rows, int cols, int max_k1, int max_k2)
    : axis1_(rows, max_k1, 1.0 / std::sqrt(static_cast<double>(rows) * cols)),
      axis2_(cols, max_k2, 1.0),
      half_cols_(cols / 2 + 1) {}

SpectrumBox SpectrumFolding::Unfold(const Complex* half_spectrum) const {
  SpectrumBox box(axis1_.max_k, axis2_.max_k);
  for (int k1 = -box.max_k1; k1 <= box.max_k1; ++k1) {
    const Complex* same = half_spectrum + std::ptrdiff_t{axis1_.Index(k1)} * half_cols_;
    const Complex* opposite = half_spectrum + std::ptrdiff_t{axis1_.Index(-k1)} * half_cols_;
    Complex* out = box.Row(k1);
    for (int k2 = k1 < 0 ? -box.max_k2 : 0; k2 <= box.max_k2; ++k2) {
      const int index = axis2_.Index(k2);
      const Complex value = index < half_cols_ ? same[index] : std::conj(opposite[axis2_.Index(-k2)]);
      out[k2] = Times(value, Times(axis1_.Phase(k1), axis2_.Phase(k2)));
    }
  }
  return box;
}

void SpectrumFolding::AddFolded(const SpectrumBox& box, Complex* half_spectrum) const {
  for (int k1 = -box.max_k1; k1 <= box.max_k1; ++k1) {
    Complex* same = half_spectrum + std::ptrdiff_t{axis1_.Index(k1)} * half_cols_;
    Complex* opposite = half_spectrum + std::ptrdiff_t{axis1_.Index(-k1)} * half_cols_;
    const Complex* in = box.Row(k1);
    for (int k2 = -box.max_k2; k2 <= box.max_k2; ++k2) {
      const Complex value = Times(in[k2], std::conj(Times(axis1_.Phase(k1), axis2_.Phase(k2))));
      if (axis2_.Index(k2) < half_cols_) same[axis2_.Index(k2)] += value;
      if (axis2_.Index(-k2) < half_cols_) opposite[axis2_.Index(-k2)] += std::conj(value);
    }
  }
}

void SpectrumFolding::AddAt(int k1, int k2, Complex value, Complex* half_spectrum) const {
  half_spectrum[std::ptrdiff_t{axis1_.Index(k1)} * half_cols_ + k2] +=
      Times(value, std::conj(Times(axis1_.Phase(k1), axis2_.Phase(k2))));
}

}  // namespace curvereg
