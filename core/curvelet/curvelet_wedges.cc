// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_wedges.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "absl/strings/str_cat.h"
#include "core/base/parallel.h"
#include "core/curvelet/curvelet_windows.h"

namespace curvereg {
namespace {

// The wedges of one quadrant in its own coordinates: kappa > 0 runs outwards, eta clockwise across.
// Names as in the definition: index v is the quadrant's radial axis, h the other.
class Quadrant {
 public:
  Quadrant(int n_v, int n_h, int level, int num_wedges)
      : A_v_(LevelExtent(n_v, level)),
        A_h_(LevelExtent(n_h, level)),
        D_v_(static_cast<int>(n_v / (int64_t{6} << level))),
        P_h_(RoundedRatio(A_h_, num_wedges)),
        P_v_(RoundedRatio(A_v_, num_wedges)),
        alpha_h_(static_cast<double>(P_h_) / (2 * A_h_ - P_h_)),
        alpha_v_(static_cast<double>(P_v_) / (2 * A_v_ - P_v_)),
        outer_v_(MakeLowPass(n_v, level)),
        outer_h_(MakeLowPass(n_h, level)),
        inner_v_(MakeLowPass(n_v, level + 1)),
        inner_h_(MakeLowPass(n_h, level + 1)) {
    for (int s = 1; s <= num_wedges; ++s) {
      const int mirrored = std::min(s, num_wedges + 1 - s);
      const int centre = RoundedRatio(int64_t{2 * mirrored - 1} * A_h_, num_wedges) - A_h_;
      centres_.push_back(s == mirrored ? centre : -centre);
    }
  }

  int A_v() const { return A_v_; }
  int A_h() const { return A_h_; }
  int Centre(int s) const { return centres_[static_cast<std::size_t>(s) - 1]; }
  int NumWedges() const { return static_cast<int>(centres_.size()); }
  bool CentresRise() const {
    return std::adjacent_find(centres_.begin(), centres_.end(), std::greater_equal<int>()) == centres_.end();
  }

  // Size of a wedge's array along v and along h.
  int Length(int s) const { return A_v_ - D_v_ + (IsCorner(s) ? (P_v_ + 4) / 4 : 0); }
  int Width(int s) const {
    return IsCorner(s) ? 2 * A_h_ + 1 + Centre(1) + Centre(2) : Centre(s + 1) - Centre(s - 1) + 1;
  }

  // Scale window times angular window. Preconditions: 0 < kappa <= A_v, |eta| <= A_h.
  double Window(int s, int kappa, int eta) const {
    const double tau = static_cast<double>(eta) * A_v_ / kappa;
    // Cheap refusals first: most of the box belongs to other wedges.
    if (s > 1 && tau <= Centre(s - 1)) return 0.0;
    if (s < NumWedges() && tau >= Centre(s + 1)) return 0.0;
    const double radial = ScaleWindow(kappa, std::abs(eta));
    if (radial == 0.0) return 0.0;
    const double rising =
        s > 1 ? RisingStep((tau - Centre(s - 1)) / (Centre(s) - Centre(s - 1))) : LeftCorner(kappa, eta);
    const double falling =
        s < NumWedges() ? FallingStep((tau - Centre(s)) / (Centre(s + 1) - Centre(s))) : RightCorner(kappa, eta);
    return radial * rising * falling;
  }

 private:
  // floor(a / b + 1/2) for a, b > 0, exactly.
  static int RoundedRatio(int64_t a, int64_t b) { return static_cast<int>((2 * a + b) / (2 * b)); }

  bool IsCorner(int s) const { return s == 1 || s == NumWedges(); }

  // L_p * sqrt(1 - L_(p+1)^2), the root by its stable form. Preconditions: kappa, eta >= 0.
  double ScaleWindow(int kappa, int eta) const {
    const double stop_v = inner_v_.Stop(kappa);
    const double stop_h = inner_v_.Pass(kappa) * inner_h_.Stop(eta);
    return outer_v_.Pass(kappa) * outer_h_.Pass(eta) * std::sqrt(stop_v * stop_v + stop_h * stop_h);
  }

  // The ramps across the diagonals, shared with the neighbouring quadrants. Where b -+ e <= 0 the other factor of the
  // window is zero, and Window has returned.
  double LeftCorner(int kappa, int eta) const {
    const double b = static_cast<double>(kappa) / A_v_;
    const double e = static_cast<double>(eta) / A_h_;
    return RisingStep((alpha_v_ + (b + e) / (b - e)) / (alpha_h_ + alpha_v_));
  }
  double RightCorner(int kappa, int eta) const {
    const double b = static_cast<double>(kappa) / A_v_;
    const double e = static_cast<double>(eta) / A_h_;
    return FallingStep((alpha_h_ - (b - e) / (b + e)) / (alpha_h_ + alpha_v_));
  }

  int A_v_;  // half size of the corona's outer box
  int A_h_;
  int D_v_;  // what a wedge's array leaves out at the middle
  int P_h_;  // distance of the outermost centre from the corner
  int P_v_;
  double alpha_h_;
  double alpha_v_;
  LowPass outer_v_;
  LowPass outer_h_;
  LowPass inner_v_;
  LowPass inner_h_;
  std::vector<int> centres_;  // epsilon_s, on the outer edge kappa = A_v
};

Quadrant MakeQuadrant(int rows, int cols, bool is_north, int scale, const CurveletOptions& options) {
  const int num_wedges = NumAngles(scale, options) / 4;
  const int level = options.num_scales - scale;
  return is_north ? Quadrant(rows, cols, level, num_wedges) : Quadrant(cols, rows, level, num_wedges);
}

// Appends the non-zero stretch of `row` (weights of k2 = first_k2, ...) to the wedge.
void AppendRun(int k1, int first_k2, const std::vector<double>& row, CurveletWedge& wedge) {
  const auto is_set = [](double weight) { return weight != 0.0; };
  const auto begin = std::find_if(row.begin(), row.end(), is_set);
  if (begin == row.end()) return;
  const auto end = std::find_if(row.rbegin(), row.rend(), is_set).base();
  wedge.runs.push_back({.k1 = k1,
                        .k2 = first_k2 + static_cast<int>(begin - row.begin()),
                        .size = static_cast<int>(end - begin),
                        .first_weight = wedge.weights.size()});
  wedge.weights.insert(wedge.weights.end(), begin, end);
}

// Wedge s of the north: kappa = -k1, eta = k2.
CurveletWedge MakeNorthWedge(const Quadrant& quadrant, int s) {
  CurveletWedge wedge;
  wedge.rows = quadrant.Length(s);
  wedge.cols = quadrant.Width(s);
  wedge.centre_k1 = -quadrant.A_v();
  wedge.centre_k2 = quadrant.Centre(s);
  std::vector<double> row(static_cast<std::size_t>(2 * quadrant.A_h() + 1));
  for (int kappa = quadrant.A_v(); kappa > 0; --kappa) {
    for (int eta = -quadrant.A_h(); eta <= quadrant.A_h(); ++eta) {
      row[static_cast<std::size_t>(eta + quadrant.A_h())] = quadrant.Window(s, kappa, eta);
    }
    AppendRun(-kappa, -quadrant.A_h(), row, wedge);
  }
  return wedge;
}

// Wedge s of the east: kappa = k2, eta = k1.
CurveletWedge MakeEastWedge(const Quadrant& quadrant, int s) {
  CurveletWedge wedge;
  wedge.rows = quadrant.Width(s);
  wedge.cols = quadrant.Length(s);
  wedge.centre_k1 = quadrant.Centre(s);
  wedge.centre_k2 = quadrant.A_v();
  std::vector<double> row(static_cast<std::size_t>(quadrant.A_v()));
  for (int eta = -quadrant.A_h(); eta <= quadrant.A_h(); ++eta) {
    for (int kappa = 1; kappa <= quadrant.A_v(); ++kappa) {
      row[static_cast<std::size_t>(kappa) - 1] = quadrant.Window(s, kappa, eta);
    }
    AppendRun(eta, 1, row, wedge);
  }
  return wedge;
}

}  // namespace

int DefaultNumScales(int rows, int cols) {
  // The least J with 2^(J + 3) >= min(rows, cols).
  const auto shorter = static_cast<unsigned>(std::max(std::min(rows, cols), 1));
  return std::max(2, static_cast<int>(std::bit_width(shorter - 1)) - 3);
}

int NumAngles(int scale, const CurveletOptions& options) {
  const bool is_wavelet = scale == 1 || (scale == options.num_scales && options.finest == FinestScale::kWavelets);
  return is_wavelet ? 1 : options.num_angles_coarse << ((scale - 1) / 2);
}

int LevelExtent(int n, int level) { return static_cast<int>(2 * int64_t{n} / (int64_t{3} << level)); }

absl::Status ValidateCurveletOptions(int rows, int cols, const CurveletOptions& options) {
  CurveletOptions filled = options;
  if (filled.num_scales == 0) filled.num_scales = DefaultNumScales(rows, cols);
  if (absl::Status status = ValidateScales(rows, cols, filled.num_scales); !status.ok()) return status;
  const int n = filled.num_angles_coarse;
  if (n != 8 && n != 16 && n != 32 && n != 64) {
    return absl::InvalidArgumentError(absl::StrCat(n, " angles at scale 2; must be 8, 16, 32 or 64"));
  }
  for (int scale = 2; scale <= filled.num_scales; ++scale) {
    if (NumAngles(scale, filled) == 1) continue;
    for (const bool is_north : {true, false}) {
      if (MakeQuadrant(rows, cols, is_north, scale, filled).CentresRise()) continue;
      return absl::InvalidArgumentError(absl::StrCat(n, " angles at scale 2 are too many for an image of ", rows, " x ",
                                                     cols, " with ", filled.num_scales, " scales"));
    }
  }
  return absl::OkStatus();
}

std::vector<CurveletWedge> MakeWedges(int rows, int cols, int scale, const CurveletOptions& options) {
  const Quadrant north = MakeQuadrant(rows, cols, true, scale, options);
  const Quadrant east = MakeQuadrant(rows, cols, false, scale, options);
  const int per_quadrant = north.NumWedges();
  std::vector<CurveletWedge> wedges(static_cast<std::size_t>(2 * per_quadrant));
  ParallelFor(2 * per_quadrant, [&](int i) {
    CurveletWedge& wedge = wedges[static_cast<std::size_t>(i)];
    wedge = i < per_quadrant ? MakeNorthWedge(north, i + 1) : MakeEastWedge(east, i + 1 - per_quadrant);
    wedge.scale = scale;
    wedge.angle = i + 1;
    wedge.weights.shrink_to_fit();
  });
  return wedges;
}

}  // namespace curvereg
