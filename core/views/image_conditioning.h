// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Conditioning of an image before the periodic transform: no holes (push-pull), little noise, no trend and no step at
// its border (a raised-cosine window [Harris 1978]).
#ifndef CURVEREG_CORE_VIEWS_IMAGE_CONDITIONING_H_
#define CURVEREG_CORE_VIEWS_IMAGE_CONDITIONING_H_

#include <cstdint>

#include "core/base/image.h"

namespace curvereg {

// Replaces invalid pixels by smooth interpolation of the valid ones: push-pull over an image pyramid, which averages
// the valid pixels into coarser levels and fills from there [Gortler 1996]. Valid pixels stay as they are. Without any
// valid pixel the image becomes 0. O(pixels).
void FillHoles(const Image<uint8_t>& valid, Image<float>& image);

// Marks a valid pixel invalid when it differs by more than `max_deviation` from the median of the valid pixels in the
// window of (2 * radius + 1)^2 about it, or has fewer than two others there. O(pixels x window).
void RemoveSpikes(int radius, float max_deviation, const Image<float>& image, Image<uint8_t>& valid);

// Separable 3x3 Gaussian of standard deviation `sigma_px` (0.5 in the paper), borders clamped. sigma_px <= 0: no
// change.
void GaussianBlur3x3(double sigma_px, Image<float>& image);

// Subtracts the linear trend, the plane a + b*row + c*col fitted to the valid pixels (least squares), from all pixels.
void Detrend(const Image<uint8_t>& valid, Image<float>& image);

// Apodization: multiplies the outer `width_px` pixels by a raised cosine that reaches 0 at the border. Precondition:
// the image's level is near 0 (after Detrend), else the window itself makes a step.
void Apodize(int width_px, Image<float>& image);

// Fraction of valid pixels in the window of (2 * radius + 1)^2 pixels about each pixel, counted inside the image, in
// [0, 1].
Image<float> ValidFraction(const Image<uint8_t>& valid, int radius);

}  // namespace curvereg

#endif  // CURVEREG_CORE_VIEWS_IMAGE_CONDITIONING_H_
