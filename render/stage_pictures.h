// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Plots of the pipeline's images, for `inspect`: pixels, colour bar and legend; title and axes are the caller's. Each
// has `zoom` x `zoom` pixels per image pixel, zoom >= 1.
#ifndef CURVEREG_RENDER_STAGE_PICTURES_H_
#define CURVEREG_RENDER_STAGE_PICTURES_H_

#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/features/keypoints.h"
#include "render/plot.h"

namespace curvereg {

// Values in HeightColour from the 2nd to the 98th percentile of the valid ones; invalid pixels are grey.
// Precondition: images of one size.
Plot ValuePlot(const Image<float>& values, const Image<uint8_t>& valid, int zoom = 1);

// Values in SignedColour; full colour from the 99.5th percentile of their magnitude on.
Plot SignedPlot(const Image<float>& values, int zoom = 1);

// Key points as circles on the grey image: red maxima, blue minima; the coarser the level the larger.
// `num_levels`: levels of the DoC stack, the finest has the smallest circle.
Plot KeypointPlot(const Image<float>& values, const std::vector<Keypoint>& keypoints, int num_levels, int zoom = 1);

}  // namespace curvereg

#endif  // CURVEREG_RENDER_STAGE_PICTURES_H_
