// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/voxel_map.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/parallel.h"

namespace curvereg {
namespace {

constexpr int kKeyBits = 21;
constexpr int kKeyOffset = 1 << (kKeyBits - 1);
constexpr uint64_t kEmptyKey = ~uint64_t{0};
constexpr uint64_t kHashFactor = 0x9E3779B97F4A7C15ULL;
constexpr double kMinWidth = 0.06;         // of a cell: standard deviation across; a filled cell has 0.29
constexpr size_t kPointsPerBlock = 65536;  // fixed, so that the order of sums does not depend on the thread count

int FloorToInt(float value) {
  const int truncated = static_cast<int>(value);
  return truncated - static_cast<int>(value < static_cast<float>(truncated));
}

uint64_t PackKey(int ix, int iy, int iz) {
  return (static_cast<uint64_t>(ix + kKeyOffset) << (2 * kKeyBits)) |
         (static_cast<uint64_t>(iy + kKeyOffset) << kKeyBits) | static_cast<uint64_t>(iz + kKeyOffset);
}

uint64_t CellKey(const Eigen::Vector3f& point, float inverse_cell) {
  return PackKey(FloorToInt(point.x() * inverse_cell), FloorToInt(point.y() * inverse_cell),
                 FloorToInt(point.z() * inverse_cell));
}

Eigen::Vector3i UnpackKey(uint64_t key) {
  constexpr uint64_t kMask = (uint64_t{1} << kKeyBits) - 1;
  return {static_cast<int>((key >> (2 * kKeyBits)) & kMask) - kKeyOffset,
          static_cast<int>((key >> kKeyBits) & kMask) - kKeyOffset, static_cast<int>(key & kMask) - kKeyOffset};
}

// Sums over a cell's points, relative to the cell's centre to keep precision far from the origin.
struct Moments {
  double n = 0.0;
  double x = 0.0, y = 0.0, z = 0.0;
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;
  Eigen::Vector3f first = Eigen::Vector3f::Zero();
};

// Adds `other`, whose centre lies `shift` from that of `moments`.
void AddMoments(const Moments& other, const Eigen::Vector3d& shift, Moments& moments) {
  if (moments.n == 0.0) moments.first = other.first;
  const double dx = shift.x(), dy = shift.y(), dz = shift.z();
  moments.xx += other.xx + 2.0 * dx * other.x + other.n * dx * dx;
  moments.yy += other.yy + 2.0 * dy * other.y + other.n * dy * dy;
  moments.zz += other.zz + 2.0 * dz * other.z + other.n * dz * dz;
  moments.xy += other.xy + dx * other.y + dy * other.x + other.n * dx * dy;
  moments.xz += other.xz + dx * other.z + dz * other.x + other.n * dx * dz;
  moments.yz += other.yz + dy * other.z + dz * other.y + other.n * dy * dz;
  moments.x += other.x + other.n * dx;
  moments.y += other.y + other.n * dy;
  moments.z += other.z + other.n * dz;
  moments.n += other.n;
}

// Cells in order of first visit, with a growing open-addressing index.
class MomentGrid {
 public:
  explicit MomentGrid(size_t expected_cells) { Rehash(std::bit_ceil(std::max<size_t>(64, 2 * expected_cells))); }

  Moments& At(uint64_t key) {
    if (key == last_key_) return cells_[last_cell_];
    size_t slot = (key * kHashFactor) >> shift_;
    while (slot_keys_[slot] != key) {
      if (slot_keys_[slot] == kEmptyKey) {
        if (2 * (keys_.size() + 1) > slot_keys_.size()) {
          Rehash(2 * slot_keys_.size());
          return At(key);
        }
        slot_keys_[slot] = key;
        slot_cells_[slot] = static_cast<uint32_t>(keys_.size());
        keys_.push_back(key);
        cells_.emplace_back();
        break;
      }
      slot = (slot + 1) & (slot_keys_.size() - 1);
    }
    last_key_ = key;
    last_cell_ = slot_cells_[slot];
    return cells_[last_cell_];
  }

  const std::vector<uint64_t>& keys() const { return keys_; }
  const std::vector<Moments>& cells() const { return cells_; }

 private:
  void Rehash(size_t num_slots) {
    slot_keys_.assign(num_slots, kEmptyKey);
    slot_cells_.assign(num_slots, 0);
    shift_ = 64 - std::countr_zero(num_slots);
    for (size_t i = 0; i < keys_.size(); ++i) {
      size_t slot = (keys_[i] * kHashFactor) >> shift_;
      while (slot_keys_[slot] != kEmptyKey) slot = (slot + 1) & (num_slots - 1);
      slot_keys_[slot] = keys_[i];
      slot_cells_[slot] = static_cast<uint32_t>(i);
    }
  }

  std::vector<uint64_t> slot_keys_;
  std::vector<uint32_t> slot_cells_;
  int shift_ = 0;
  std::vector<uint64_t> keys_;
  std::vector<Moments> cells_;
  uint64_t last_key_ = kEmptyKey;
  size_t last_cell_ = 0;
};

void AccumulatePoints(const Eigen::Vector3f* begin, const Eigen::Vector3f* end, float cell, MomentGrid& grid) {
  const float inverse_cell = 1.0F / cell;
  for (const Eigen::Vector3f* point = begin; point != end; ++point) {
    if (!point->allFinite()) continue;
    const int ix = FloorToInt(point->x() * inverse_cell);
    const int iy = FloorToInt(point->y() * inverse_cell);
    const int iz = FloorToInt(point->z() * inverse_cell);
    Moments& m = grid.At(PackKey(ix, iy, iz));
    const double x = point->x() - (static_cast<float>(ix) + 0.5F) * cell;
    const double y = point->y() - (static_cast<float>(iy) + 0.5F) * cell;
    const double z = point->z() - (static_cast<float>(iz) + 0.5F) * cell;
    if (m.n == 0.0) m.first = *point;
    m.n += 1.0;
    m.x += x;
    m.y += y;
    m.z += z;
    m.xx += x * x;
    m.xy += x * y;
    m.xz += x * z;
    m.yy += y * y;
    m.yz += y * z;
    m.zz += z * z;
  }
}

MomentGrid FinestGrid(const std::vector<Eigen::Vector3f>& points, double cell_m, const Stop& stop) {
  const size_t num_blocks = std::max<size_t>(1, (points.size() + kPointsPerBlock - 1) / kPointsPerBlock);
  std::vector<MomentGrid> grids(num_blocks, MomentGrid(2048));
  ParallelFor(static_cast<int>(num_blocks), [&](int block) {
    if (stop.Requested()) return;
    const size_t begin = static_cast<size_t>(block) * kPointsPerBlock;
    const size_t end = std::min(points.size(), begin + kPointsPerBlock);
    AccumulatePoints(points.data() + begin, points.data() + end, static_cast<float>(cell_m),
                     grids[static_cast<size_t>(block)]);
  });
  MomentGrid total = std::move(grids.front());
  for (size_t block = 1; block < num_blocks && !stop.Requested(); ++block) {
    const MomentGrid& grid = grids[block];
    for (size_t i = 0; i < grid.keys().size(); ++i) {
      AddMoments(grid.cells()[i], Eigen::Vector3d::Zero(), total.At(grid.keys()[i]));
    }
  }
  return total;
}

MomentGrid Coarsened(const MomentGrid& fine, double fine_cell_m) {
  MomentGrid coarse(fine.keys().size() / 3);
  for (size_t i = 0; i < fine.keys().size(); ++i) {
    const Eigen::Vector3i child = UnpackKey(fine.keys()[i]);
    const Eigen::Vector3i parent(child.x() >> 1, child.y() >> 1, child.z() >> 1);
    const Eigen::Vector3d side = (child - 2 * parent).cast<double>();  // 0 or 1 on each axis
    const Eigen::Vector3d shift = (side.array() - 0.5) * fine_cell_m;
    AddMoments(fine.cells()[i], shift, coarse.At(PackKey(parent.x(), parent.y(), parent.z())));
  }
  return coarse;
}

Surfel SurfelFromMoments(const Moments& m, const Eigen::Vector3d& centre, double cell_m) {
  const Eigen::Vector3d offset(m.x / m.n, m.y / m.n, m.z / m.n);
  Eigen::Matrix3d covariance;
  covariance << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  covariance = covariance / m.n - offset * offset.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3d mean = centre + offset;
  Eigen::Vector3d normal = solver.eigenvectors().col(0);
  if (normal.dot(mean) > 0.0) normal = -normal;
  Surfel surfel;
  surfel.mean = mean.cast<float>();
  surfel.normal = normal.cast<float>();
  surfel.covariance = covariance.cast<float>();
  surfel.first_point = m.first;
  surfel.normal_variance = std::max(0.0F, static_cast<float>(solver.eigenvalues()[0]));
  surfel.middle_variance = std::max(0.0F, static_cast<float>(solver.eigenvalues()[1]));
  surfel.count = static_cast<int>(m.n);
  surfel.has_normal = surfel.middle_variance > std::pow(kMinWidth * cell_m, 2);
  return surfel;
}

VoxelMap MapFromGrid(const MomentGrid& grid, double cell_m, int min_points) {
  std::vector<uint64_t> keys;
  std::vector<const Moments*> cells;
  for (size_t i = 0; i < grid.keys().size(); ++i) {
    if (grid.cells()[i].n < min_points) continue;
    keys.push_back(grid.keys()[i]);
    cells.push_back(&grid.cells()[i]);
  }
  std::vector<Surfel> surfels(keys.size());
  constexpr size_t kBlock = 1024;
  ParallelFor(static_cast<int>((keys.size() + kBlock - 1) / kBlock), [&](int block) {
    const size_t begin = static_cast<size_t>(block) * kBlock;
    for (size_t i = begin; i < std::min(keys.size(), begin + kBlock); ++i) {
      const Eigen::Vector3d centre = (UnpackKey(keys[i]).cast<double>().array() + 0.5) * cell_m;
      surfels[i] = SurfelFromMoments(*cells[i], centre, cell_m);
    }
  });
  return VoxelMap(cell_m, std::move(surfels), keys);
}

}  // namespace

VoxelMap::VoxelMap(double cell_m, std::vector<Surfel> surfels, const std::vector<uint64_t>& keys)
    : cell_m_(cell_m), inverse_cell_(1.0F / static_cast<float>(cell_m)), surfels_(std::move(surfels)) {
  const size_t num_slots = std::bit_ceil(std::max<size_t>(64, 2 * keys.size()));
  slot_keys_.assign(num_slots, kEmptyKey);
  slot_surfels_.assign(num_slots, -1);
  shift_ = 64 - std::countr_zero(num_slots);
  for (size_t i = 0; i < keys.size(); ++i) {
    size_t slot = (keys[i] * kHashFactor) >> shift_;
    while (slot_keys_[slot] != kEmptyKey) slot = (slot + 1) & (num_slots - 1);
    slot_keys_[slot] = keys[i];
    slot_surfels_[slot] = static_cast<int32_t>(i);
  }
}

int VoxelMap::Find(const Eigen::Vector3f& point) const {
  if (surfels_.empty()) return -1;
  const uint64_t key = CellKey(point, inverse_cell_);
  size_t slot = (key * kHashFactor) >> shift_;
  while (slot_keys_[slot] != kEmptyKey) {
    if (slot_keys_[slot] == key) return slot_surfels_[slot];
    slot = (slot + 1) & (slot_keys_.size() - 1);
  }
  return -1;
}

std::vector<VoxelMap> BuildVoxelMaps(const std::vector<Eigen::Vector3f>& points, const VoxelOptions& options,
                                     const Stop& stop) {
  std::vector<MomentGrid> grids;
  grids.push_back(FinestGrid(points, options.finest_cell_m, stop));
  if (stop.Requested()) return std::vector<VoxelMap>(static_cast<size_t>(options.num_levels));
  for (int level = 1; level < options.num_levels; ++level) {
    grids.push_back(Coarsened(grids.back(), options.finest_cell_m * (1 << (level - 1))));
  }
  std::vector<VoxelMap> maps(grids.size());
  ParallelFor(options.num_levels, [&](int level) {
    const double cell_m = options.finest_cell_m * (1 << level);
    maps[static_cast<size_t>(level)] = MapFromGrid(grids[static_cast<size_t>(level)], cell_m, options.min_points);
  });
  return maps;
}

}  // namespace curvereg
