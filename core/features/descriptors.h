// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Descriptors: a spatial histogram of gradients about each key point, 4x4 cells of 8 directions = 128 bins over a
// window of 16x16 samples [paper, section 3.3], turned by the key point's dominant gradient directions where asked.
#ifndef CURVEREG_CORE_FEATURES_DESCRIPTORS_H_
#define CURVEREG_CORE_FEATURES_DESCRIPTORS_H_

#include <vector>

#include "core/base/image.h"
#include "core/features/keypoints.h"

namespace curvereg {

inline constexpr int kDescriptorSize = 128;

struct DescriptorOptions {
  double step_px = 1.5;            // distance of the 16x16 samples; 1 in the paper
  bool oriented = true;            // false, as in the paper: the window stays aligned with the image
  double second_peak_share = 0.8;  // further directions of at least this share of the strongest give a feature each
  int max_orientations = 2;
};

// Key points with direction and descriptor; a key point of two directions appears twice. Parallel arrays.
struct Features {
  std::vector<Keypoint> keypoints;
  std::vector<float> orientations_rad;  // direction of the dominant gradient, from +col towards +row, in [-pi, pi)
  std::vector<float> descriptors;       // kDescriptorSize values each, unit length
  size_t size() const { return keypoints.size(); }
  const float* Descriptor(size_t i) const { return descriptors.data() + i * kDescriptorSize; }
};

// Describes each key point on the image of its own level, `images[keypoint.level]` (same sizes). Samples outside the
// image count as flat. A key point without any gradient gets no feature. Order follows `keypoints`.
Features DescribeKeypoints(const std::vector<Image<float>>& images, const std::vector<Keypoint>& keypoints,
                           const DescriptorOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_FEATURES_DESCRIPTORS_H_
