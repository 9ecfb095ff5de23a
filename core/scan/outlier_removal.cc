// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/outlier_removal.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/parallel.h"
#include "core/scan/cube_map.h"

namespace curvereg {
namespace {

struct Return {
  float range, height;
};

// Returns grouped by the bin of their direction (counting sort).
struct BinnedReturns {
  CubeMap cube;
  std::vector<int> bin_of_point;    // -1 for points that are not finite or at the origin
  std::vector<uint32_t> bin_begin;  // num_bins + 1
  std::vector<Return> returns;      // by bin
};

BinnedReturns SortIntoBins(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& up, int bins_per_side,
                           const Stop& stop) {
  constexpr size_t kPointsPerQuestion = 65536;
  BinnedReturns binned{{bins_per_side}, std::vector<int>(points.size(), -1), {}, {}};
  binned.bin_begin.assign(static_cast<size_t>(binned.cube.num_bins()) + 1, 0);
  for (size_t i = 0; i < points.size(); ++i) {
    if (i % kPointsPerQuestion == 0 && stop.Requested()) break;
    if (!points[i].allFinite() || points[i].isZero(0.0F)) continue;
    binned.bin_of_point[i] = binned.cube.BinOf(points[i]);
    ++binned.bin_begin[static_cast<size_t>(binned.bin_of_point[i]) + 1];
  }
  for (size_t bin = 1; bin < binned.bin_begin.size(); ++bin) binned.bin_begin[bin] += binned.bin_begin[bin - 1];
  binned.returns.resize(binned.bin_begin.back());
  std::vector<uint32_t> next(binned.bin_begin.begin(), binned.bin_begin.end() - 1);
  for (size_t i = 0; i < points.size(); ++i) {
    if (i % kPointsPerQuestion == 0 && stop.Requested()) break;
    if (binned.bin_of_point[i] < 0) continue;
    binned.returns[next[static_cast<size_t>(binned.bin_of_point[i])]++] = {points[i].norm(), points[i].dot(up)};
  }
  return binned;
}

bool IsSupported(const BinnedReturns& binned, int bin, const Return& own, const OutlierRemovalOptions& options) {
  const float range_limit =
      static_cast<float>(options.range_m) + static_cast<float>(options.range_per_m2) * own.range * own.range;
  const float height_limit =
      static_cast<float>(options.height_m) + static_cast<float>(options.height_per_m) * own.range;
  int agreeing = -1;  // the return finds itself
  int neighbours = -1;
  binned.cube.ForNeighbours(bin, [&](int other_bin) {
    const auto b = static_cast<size_t>(other_bin);
    for (uint32_t i = binned.bin_begin[b]; i < binned.bin_begin[b + 1]; ++i) {
      const Return& other = binned.returns[i];
      ++neighbours;
      agreeing += static_cast<int>(std::abs(other.range - own.range) < range_limit) &
                  static_cast<int>(std::abs(other.height - own.height) < height_limit);
    }
  });
  const double needed = std::max<double>(options.min_agreeing, options.min_agreeing_share * neighbours);
  return agreeing >= needed;
}

}  // namespace

std::vector<Eigen::Vector3f> RemoveOutliers(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& up,
                                            const OutlierRemovalOptions& options, const Stop& stop) {
  const Eigen::Vector3f up_f = up.cast<float>();
  const BinnedReturns binned = SortIntoBins(points, up_f, options.bins_per_side, stop);
  constexpr size_t kBlock = 16384;
  constexpr size_t kPointsPerQuestion = 512;  // each looks at thousands of neighbours where the scan is dense
  std::vector<std::vector<Eigen::Vector3f>> kept((points.size() + kBlock - 1) / kBlock);
  ParallelFor(static_cast<int>(kept.size()), [&](int block) {
    const size_t begin = static_cast<size_t>(block) * kBlock;
    for (size_t i = begin; i < std::min(points.size(), begin + kBlock); ++i) {
      if (i % kPointsPerQuestion == 0 && stop.Requested()) return;
      if (binned.bin_of_point[i] < 0) continue;
      const Return own{points[i].norm(), points[i].dot(up_f)};
      if (IsSupported(binned, binned.bin_of_point[i], own, options))
        kept[static_cast<size_t>(block)].push_back(points[i]);
    }
  });
  std::vector<Eigen::Vector3f> result;
  result.reserve(points.size());
  for (const std::vector<Eigen::Vector3f>& block : kept) result.insert(result.end(), block.begin(), block.end());
  return result;
}

}  // namespace curvereg
