// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// How curvelets tile the frequency plane [FDCT, section 4], with Matlab-style windows (core/README.md): each scale is a
// square corona, cut by direction into wedges that get twice as many with every second finer scale.
//
// Frequencies are (k1, k2), cycles per image downwards and to the right. Quadrants in order north (k1 < 0), east
// (k2 > 0), south, west; wedges l = 1, 2, ... run clockwise from the top-left corner. Wedge l + n/2 is wedge l seen at
// -(k1, k2), so only the first n/2 wedges, north and east, are ever built.
#ifndef CURVEREG_CORE_CURVELET_CURVELET_WEDGES_H_
#define CURVEREG_CORE_CURVELET_CURVELET_WEDGES_H_

#include <cstddef>
#include <vector>

#include "absl/status/status.h"

namespace curvereg {

enum class FinestScale {
  kWavelets,  // one array of the image's size without direction
  kCurvelets,
};

struct CurveletOptions {
  int num_scales = 0;          // >= 2; 0: DefaultNumScales of the image
  int num_angles_coarse = 16;  // wedges at scale 2: 8, 16, 32 or 64; others give wedges that are no tight frame
  // Default kWavelets, as published: a third of the memory of kCurvelets.
  FinestScale finest = FinestScale::kWavelets;
};

// ceil(log2(min(rows, cols)) - 3), but at least 2.
int DefaultNumScales(int rows, int cols);

// OK, or INVALID_ARGUMENT: what ValidateScales refuses, num_angles_coarse not in the list, or so many angles that two
// wedges of a scale of this image would have the same centre.
absl::Status ValidateCurveletOptions(int rows, int cols, const CurveletOptions& options);

// Number of wedges at `scale` in [1, num_scales]; 1 at scales that hold wavelets. Precondition: num_scales > 0.
int NumAngles(int scale, const CurveletOptions& options);

// Frequencies 0 <= k <= LevelExtent belong to the box of level p: floor(2n / (3 * 2^p)).
int LevelExtent(int n, int level);

// One wedge. Its coefficients form an array of rows x cols; its spectrum wraps into that array by
// (k1 mod rows, k2 mod cols).
struct CurveletWedge {
  // weights[first_weight + i] is the window at (k1, k2 + i), i = 0 .. size - 1.
  struct Run {
    int k1 = 0;
    int k2 = 0;
    int size = 0;
    std::size_t first_weight = 0;
  };
  int scale = 0;  // 2 .. num_scales
  int angle = 0;  // l, 1 .. NumAngles / 2
  int rows = 0;
  int cols = 0;
  double centre_k1 = 0.0;  // centre frequency on the outer edge of the corona
  double centre_k2 = 0.0;
  std::vector<Run> runs;  // by rising k1; what they leave out is zero
  std::vector<double> weights;
};

// Wedges 1 .. NumAngles / 2 of a curvelet scale; windows in parallel. Precondition: the options are valid, with
// num_scales > 0, and `scale` holds curvelets.
std::vector<CurveletWedge> MakeWedges(int rows, int cols, int scale, const CurveletOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_CORE_CURVELET_CURVELET_WEDGES_H_
