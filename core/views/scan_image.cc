// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/views/scan_image.h"

#include <algorithm>
#include <bit>

#include "core/base/parallel.h"

namespace curvereg {
namespace {

// Fixed, so that the order of sums does not depend on the thread count; few, as each has an image of its own.
constexpr size_t kPointsPerBlock = 131072;

// Levelled coordinates in single precision, cell indices from the image corner.
struct Projector {
  Eigen::Matrix3f R;
  float inverse_cell;
  float half;
  int size;

  Projector(const Eigen::Matrix3d& R_level_sensor, const BirdsEyeOptions& options)
      : R(R_level_sensor.cast<float>()),
        inverse_cell(1.0F / static_cast<float>(options.cell_m)),
        half(0.5F * static_cast<float>(options.size)),
        size(options.size) {}

  // Calls visit(pixel index, height) for each finite point inside the image.
  template <typename Visit>
  void ForEach(const Eigen::Vector3f* begin, const Eigen::Vector3f* end, const Visit& visit) const {
    const float r00 = R(0, 0) * inverse_cell, r01 = R(0, 1) * inverse_cell, r02 = R(0, 2) * inverse_cell;
    const float r10 = R(1, 0) * inverse_cell, r11 = R(1, 1) * inverse_cell, r12 = R(1, 2) * inverse_cell;
    const float r20 = R(2, 0), r21 = R(2, 1), r22 = R(2, 2);
    const auto limit = static_cast<float>(size);
    for (const Eigen::Vector3f* p = begin; p != end; ++p) {
      const float x = p->x(), y = p->y(), z = p->z();
      const float col = r00 * x + r01 * y + r02 * z + half;
      const float row = r10 * x + r11 * y + r12 * z + half;
      const float height = r20 * x + r21 * y + r22 * z;
      // Also false for points that are not finite.
      if (!(col >= 0.0F && col < limit && row >= 0.0F && row < limit && height - height == 0.0F)) continue;
      visit(static_cast<size_t>(static_cast<int>(row) * size + static_cast<int>(col)), height);
    }
  }
};

size_t NumBlocks(size_t num_points) {
  return std::max<size_t>(1, (num_points + kPointsPerBlock - 1) / kPointsPerBlock);
}

template <typename Visit>
void ForEachInBlock(const std::vector<Eigen::Vector3f>& points, size_t block, const Projector& projector,
                    const Visit& visit) {
  const size_t begin = block * kPointsPerBlock;
  const size_t end = std::min(points.size(), begin + kPointsPerBlock);
  projector.ForEach(points.data() + begin, points.data() + end, visit);
}

struct HeightSum {
  float sum = 0.0F;
  float count = 0.0F;
};

// Lower median of each cell's heights: sorts the heights by cell, then selects.
BirdsEyeImage MedianElevationImage(const std::vector<Eigen::Vector3f>& points, const Projector& projector,
                                   const BirdsEyeOptions& options, const Stop& stop) {
  BirdsEyeImage result;
  result.cell_m = options.cell_m;
  result.values = Image<float>(options.size, options.size);
  result.valid = Image<uint8_t>(options.size, options.size);
  std::vector<uint32_t> begin(result.values.size() + 1, 0);
  const size_t num_blocks = NumBlocks(points.size());
  for (size_t block = 0; block < num_blocks && !stop.Requested(); ++block) {
    ForEachInBlock(points, block, projector, [&](size_t pixel, float) { ++begin[pixel + 1]; });
  }
  for (size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  std::vector<float> heights(begin.back());
  std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
  for (size_t block = 0; block < num_blocks; ++block) {
    if (stop.Requested()) return result;
    ForEachInBlock(points, block, projector, [&](size_t pixel, float height) { heights[next[pixel]++] = height; });
  }
  for (size_t i = 0; i < result.values.size(); ++i) {
    if (begin[i] == begin[i + 1]) continue;
    const auto cell = heights.begin() + begin[i];
    const auto middle = cell + (begin[i + 1] - begin[i] - 1) / 2;
    std::nth_element(cell, middle, heights.begin() + begin[i + 1]);
    result.values.pixels[i] = *middle;
    result.valid.pixels[i] = 1;
  }
  return result;
}

}  // namespace

BirdsEyeImage ElevationImage(const std::vector<Eigen::Vector3f>& points, const Eigen::Matrix3d& R_level_sensor,
                             const BirdsEyeOptions& options, const Stop& stop) {
  const Projector projector(R_level_sensor, options);
  if (options.median) return MedianElevationImage(points, projector, options, stop);
  std::vector<Image<HeightSum>> sums(NumBlocks(points.size()));
  ParallelFor(static_cast<int>(sums.size()), [&](int block) {
    Image<HeightSum>& image = sums[static_cast<size_t>(block)];
    image = Image<HeightSum>(options.size, options.size);
    if (stop.Requested()) return;
    ForEachInBlock(points, static_cast<size_t>(block), projector, [&](size_t pixel, float height) {
      image.pixels[pixel].sum += height;
      image.pixels[pixel].count += 1.0F;
    });
  });
  BirdsEyeImage result;
  result.cell_m = options.cell_m;
  result.values = Image<float>(options.size, options.size);
  result.valid = Image<uint8_t>(options.size, options.size);
  for (size_t i = 0; i < result.values.size(); ++i) {
    HeightSum total;
    for (const Image<HeightSum>& image : sums) {
      total.sum += image.pixels[i].sum;
      total.count += image.pixels[i].count;
    }
    if (total.count == 0.0F) continue;
    result.values.pixels[i] = total.sum / total.count;
    result.valid.pixels[i] = 1;
  }
  return result;
}

OccupancySlices ComputeOccupancySlices(const std::vector<Eigen::Vector3f>& points,
                                       const Eigen::Matrix3d& R_level_sensor, const BirdsEyeOptions& options,
                                       const Stop& stop) {
  constexpr auto kInverseSlice = static_cast<float>(1.0 / OccupancySlices::kSliceM);
  constexpr float kHalf = OccupancySlices::kNumSlices / 2;
  const Projector projector(R_level_sensor, options);
  std::vector<Image<uint64_t>> parts(NumBlocks(points.size()));
  ParallelFor(static_cast<int>(parts.size()), [&](int block) {
    Image<uint64_t>& image = parts[static_cast<size_t>(block)];
    image = Image<uint64_t>(options.size, options.size);
    if (stop.Requested()) return;
    ForEachInBlock(points, static_cast<size_t>(block), projector, [&](size_t pixel, float height) {
      const float slice = height * kInverseSlice + kHalf;
      if (slice < 0.0F || slice >= 2.0F * kHalf) return;
      image.pixels[pixel] |= uint64_t{1} << static_cast<int>(slice);
    });
  });
  OccupancySlices result;
  result.cell_m = options.cell_m;
  result.slices = std::move(parts.front());
  for (size_t block = 1; block < parts.size(); ++block) {
    for (size_t i = 0; i < result.slices.size(); ++i) result.slices.pixels[i] |= parts[block].pixels[i];
  }
  return result;
}

BirdsEyeImage OccupancyImage(const OccupancySlices& slices) {
  BirdsEyeImage result;
  result.cell_m = slices.cell_m;
  result.values = Image<float>(slices.slices.rows, slices.slices.cols);
  result.valid = Image<uint8_t>(slices.slices.rows, slices.slices.cols);
  for (size_t i = 0; i < slices.slices.size(); ++i) {
    const uint64_t bits = slices.slices.pixels[i];
    result.values.pixels[i] = static_cast<float>(std::popcount(bits));
    result.valid.pixels[i] = bits != 0 ? 1 : 0;
  }
  return result;
}

}  // namespace curvereg
