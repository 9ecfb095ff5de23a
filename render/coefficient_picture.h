// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The log-coefficient display [paper, section 3.1]: all curvelet coefficients of an image in one picture.
#ifndef CURVEREG_RENDER_COEFFICIENT_PICTURE_H_
#define CURVEREG_RENDER_COEFFICIENT_PICTURE_H_

#include <cstdint>

#include "core/base/image.h"
#include "core/curvelet/curvelet_coefficients.h"
#include "render/plot.h"

namespace curvereg {

// The picture, `size_px` squared, is the frequency plane: low frequencies in the middle, each scale a square corona
// twice the size of the one below it, cut into its wedges. A wedge shows its array of coefficients the right way up, as
// log10 |c|: white is the largest magnitude of all scales but the coarsest, black a ten-thousandth of it.
// Preconditions: size_px > 0; every scale has one array or, clockwise from the top left corner, a multiple of 4. A
// scale of one array but the coarsest (wavelets) is shown as a whole behind the scales below it.
Image<uint8_t> CoefficientPicture(const ComplexCurvelets& curvelets, int size_px);

// The same with axes and colour bar, for an image whose pixels are `step_rad` wide and high.
Plot CoefficientPlot(const ComplexCurvelets& curvelets, int size_px, double step_rad);

}  // namespace curvereg

#endif  // CURVEREG_RENDER_COEFFICIENT_PICTURE_H_
