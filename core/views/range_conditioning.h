// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The range image as the method `paper` transforms it [S. Ahuja, P. Iles, S. L. Waslander, "3D Scan Registration using
// Curvelet Features in Planetary Environments"]: holes filled, 3x3 Gaussian, values on [0, 1]. Computed by OpenCV, with
// those of its functions that round once per pixel: the same bytes with any instruction set and thread count, which
// cv::GaussianBlur, cv::sepFilter2D and cv::addWeighted do not give (docs/adr/2026-11-30-opencv.md).
#ifndef CURVEREG_CORE_VIEWS_RANGE_CONDITIONING_H_
#define CURVEREG_CORE_VIEWS_RANGE_CONDITIONING_H_

#include "core/base/image.h"
#include "core/views/range_image.h"

namespace curvereg {

// The image's size, values in [0, 1]; 0 everywhere when no pixel is valid or all have one range. The panorama is
// continued around the circle by half its width first, so that column 0 is conditioned with the last column beside it.
//
// Pixels without a return are interpolated from those with one by push-pull: averages of the known pixels in a pyramid
// of halved images, then each unknown pixel from the next coarser image, bilinearly [S. Gortler, R. Grzeszczuk,
// R. Szeliski, M. Cohen, "The Lumigraph", SIGGRAPH 1996, section 3.4]. The paper names hole filling after Soille, which
// leaves what touches the border of the image, the sky, as a step. `sigma_px`: of the Gaussian, 0.5 in the paper,
// borders replicated; <= 0: no Gaussian. Precondition: the image is not empty. O(pixels).
Image<float> ConditionRange(const RangeImage& image, double sigma_px);

}  // namespace curvereg

#endif  // CURVEREG_CORE_VIEWS_RANGE_CONDITIONING_H_
