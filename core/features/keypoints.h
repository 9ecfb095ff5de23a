// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Key points: extrema of the difference of curvelets, I_DoC(j) = I_c(j) - I_c(j-1) [paper, section 3.2], over position
// and scale: a pixel larger (or smaller) than its 8 neighbours at its own scale and the 9 at each of the scales beside.
#ifndef CURVEREG_CORE_FEATURES_KEYPOINTS_H_
#define CURVEREG_CORE_FEATURES_KEYPOINTS_H_

#include <vector>

#include "core/base/image.h"

namespace curvereg {

struct KeypointOptions {
  int first_level = 1;  // index into the DoC stack; 0 is the coarsest band itself
  int last_level = 4;
  double min_response = 0.005;      // |DoC| below it is noise, in the image's unit (5 mm of height)
  double min_valid_fraction = 0.4;  // of the 9x9 window about the point: no key points on interpolated ground
  int max_per_level = 400;          // strongest first
  int border_px = 8;                // none nearer to the image border, where the taper works
};

struct Keypoint {
  float row = 0.0F;  // image coordinates, pixel centres at integers
  float col = 0.0F;
  int level = 0;          // index into the DoC stack
  float response = 0.0F;  // DoC value: positive for a maximum, negative for a minimum [image unit]
};

// DoC stack of `bands` (I_c(1) .. I_c(J)): stack[0] = I_c(1), stack[j] = I_c(j+1) - I_c(j).
std::vector<Image<float>> DifferenceOfCurvelets(const std::vector<Image<float>>& bands);

// Key points level after level, strongest first within a level (ties: image order). `valid_fraction` as of
// ValidFraction. Precondition: images of one size. A stack of fewer than 3 levels has none.
std::vector<Keypoint> DetectKeypoints(const std::vector<Image<float>>& doc_stack, const Image<float>& valid_fraction,
                                      const KeypointOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_FEATURES_KEYPOINTS_H_
