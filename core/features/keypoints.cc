// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/keypoints.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/parallel.h"

namespace curvereg {
namespace {

// Pixels above all eight neighbours of their own level by `sign`; the cheap test that leaves few for the rest.
bool IsPlaneExtremum(const float* above, const float* here, const float* below, float sign) {
  const float value = sign * here[0];
  return value > sign * here[-1] && value > sign * here[1] && value > sign * above[-1] && value > sign * above[0] &&
         value > sign * above[1] && value > sign * below[-1] && value > sign * below[0] && value > sign * below[1];
}

bool ExceedsNeighbourLevel(const Image<float>& level, int row, int col, float value, float sign) {
  for (int r = row - 1; r <= row + 1; ++r) {
    for (int c = col - 1; c <= col + 1; ++c) {
      if (sign * level(r, c) >= sign * value) return false;
    }
  }
  return true;
}

// Vertex of the parabola through three values about the middle one, within half a pixel.
float ParabolaOffset(float before, float middle, float after) {
  const float curvature = before - 2.0F * middle + after;
  if (curvature == 0.0F) return 0.0F;
  return std::clamp(0.5F * (before - after) / curvature, -0.5F, 0.5F);
}

std::vector<Keypoint> DetectLevel(const std::vector<Image<float>>& stack, int level, const Image<float>& valid_fraction,
                                  const KeypointOptions& options) {
  const Image<float>& image = stack[static_cast<size_t>(level)];
  const Image<float>& coarser = stack[static_cast<size_t>(level - 1)];
  const Image<float>& finer = stack[static_cast<size_t>(level + 1)];
  const auto min_response = static_cast<float>(options.min_response);
  const auto min_share = static_cast<float>(options.min_valid_fraction);
  const int border = std::max(1, options.border_px);
  std::vector<Keypoint> found;
  for (int row = border; row < image.rows - border; ++row) {
    const float* above = image.Row(row - 1);
    const float* here = image.Row(row);
    const float* below = image.Row(row + 1);
    const float* share = valid_fraction.Row(row);
    for (int col = border; col < image.cols - border; ++col) {
      const float value = here[col];
      if (std::abs(value) < min_response || share[col] < min_share) continue;
      const float sign = value > 0.0F ? 1.0F : -1.0F;
      if (!IsPlaneExtremum(above + col, here + col, below + col, sign)) continue;
      if (!ExceedsNeighbourLevel(coarser, row, col, value, sign)) continue;
      if (!ExceedsNeighbourLevel(finer, row, col, value, sign)) continue;
      found.push_back({static_cast<float>(row) + ParabolaOffset(above[col], value, below[col]),
                       static_cast<float>(col) + ParabolaOffset(here[col - 1], value, here[col + 1]), level, value});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Keypoint& a, const Keypoint& b) { return std::abs(a.response) > std::abs(b.response); });
  if (found.size() > static_cast<size_t>(options.max_per_level))
    found.resize(static_cast<size_t>(options.max_per_level));
  return found;
}

}  // namespace

std::vector<Image<float>> DifferenceOfCurvelets(const std::vector<Image<float>>& bands) {
  std::vector<Image<float>> stack(bands.size());
  for (size_t j = 0; j < bands.size(); ++j) {
    stack[j] = bands[j];
    if (j == 0) continue;
    for (size_t i = 0; i < stack[j].size(); ++i) stack[j].pixels[i] -= bands[j - 1].pixels[i];
  }
  return stack;
}

std::vector<Keypoint> DetectKeypoints(const std::vector<Image<float>>& doc_stack, const Image<float>& valid_fraction,
                                      const KeypointOptions& options) {
  const int first = std::max(1, options.first_level);
  const int last = std::min(options.last_level, static_cast<int>(doc_stack.size()) - 2);
  if (last < first) return {};
  std::vector<std::vector<Keypoint>> levels(static_cast<size_t>(last - first + 1));
  ParallelFor(static_cast<int>(levels.size()), [&](int i) {
    levels[static_cast<size_t>(i)] = DetectLevel(doc_stack, first + i, valid_fraction, options);
  });
  std::vector<Keypoint> keypoints;
  for (const std::vector<Keypoint>& level : levels) keypoints.insert(keypoints.end(), level.begin(), level.end());
  return keypoints;
}

}  // namespace curvereg
