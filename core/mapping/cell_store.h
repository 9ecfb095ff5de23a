// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Sums of the points per cell for a run of keys, in bounded memory: when there are too many cells, the run is cut at
// the median key and the cells beyond it are forgotten, to be done in a later pass. What is kept does not depend on
// where runs are cut.
#ifndef CURVEREG_CORE_MAPPING_CELL_STORE_H_
#define CURVEREG_CORE_MAPPING_CELL_STORE_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mapping/cell_grid.h"

namespace curvereg {

struct CellSum {
  uint64_t key = 0;
  Eigen::Vector3f offset_sum = Eigen::Vector3f::Zero();  // of PlacedPoint::offset, in the order in which they came
  uint32_t count = 0;
};

// Of the cell's points [m, map frame].
inline Eigen::Vector3d MeanOf(const CellSum& cell, const CellGrid& grid) {
  return grid.Centre(cell.key) + cell.offset_sum.cast<double>() * (grid.cell_m() / cell.count);
}

class CellStore {
 public:
  // Memory per cell at most, with what sorting and the table of places take.
  static constexpr std::size_t kBytesPerCell = 36;

  // Precondition: max_cells >= 2.
  explicit CellStore(std::size_t max_cells);

  // Forgets all cells; takes keys in [begin_key, end_key).
  void Begin(uint64_t begin_key, uint64_t end_key);
  uint64_t begin_key() const { return begin_key_; }
  uint64_t end_key() const { return end_key_; }  // less than asked for once the run was cut

  // Points outside of the run are ignored.
  void Add(const PlacedPoint& point);

  // In order of their keys. Add must not be called until Begin.
  const std::vector<CellSum>& Sort();

 private:
  static constexpr uint32_t kFree = 0xffffffff;
  uint32_t* SlotOf(uint64_t key);
  void ResizeTable(std::size_t num_slots);
  void CutRun();

  std::size_t max_cells_;
  uint64_t begin_key_ = 0;
  uint64_t end_key_ = 0;
  std::vector<CellSum> cells_;
  std::vector<uint32_t> slots_;  // open addressing: indices of cells_
  int shift_ = 0;
  std::size_t last_ = 0;  // neighbouring points tend to share a cell
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_CELL_STORE_H_
