// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/cell_store.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace curvereg {
namespace {

constexpr std::size_t kFirstSlots = 1024;

// After the table has doubled it is three eighths full.
static_assert(3 * (CellStore::kBytesPerCell - sizeof(CellSum)) >= 8 * sizeof(uint32_t));

bool HasLessKey(const CellSum& a, const CellSum& b) { return a.key < b.key; }

}  // namespace

CellStore::CellStore(std::size_t max_cells) : max_cells_(std::min<std::size_t>(max_cells, kFree)) {
  assert(max_cells >= 2);
  // Never copied to grow; what is not used takes no memory.
  cells_.reserve(max_cells_);
}

void CellStore::Begin(uint64_t begin_key, uint64_t end_key) {
  begin_key_ = begin_key;
  end_key_ = end_key;
  cells_.clear();
  ResizeTable(std::max(slots_.size(), kFirstSlots));
}

void CellStore::Add(const PlacedPoint& point) {
  if (point.key < begin_key_ || point.key >= end_key_) return;
  if (last_ >= cells_.size() || cells_[last_].key != point.key) {
    uint32_t* slot = SlotOf(point.key);
    if (*slot == kFree) {
      if (cells_.size() == max_cells_) {
        CutRun();
        if (point.key >= end_key_) return;
        slot = SlotOf(point.key);
      }
      *slot = static_cast<uint32_t>(cells_.size());
      cells_.push_back({.key = point.key});
      last_ = cells_.size() - 1;
      // At most three quarters full.
      if (4 * cells_.size() > 3 * slots_.size()) ResizeTable(2 * slots_.size());
    } else {
      last_ = *slot;
    }
  }
  CellSum& cell = cells_[last_];
  cell.offset_sum += point.offset;
  ++cell.count;
}

const std::vector<CellSum>& CellStore::Sort() {
  std::sort(cells_.begin(), cells_.end(), HasLessKey);
  return cells_;
}

uint32_t* CellStore::SlotOf(uint64_t key) {
  // Multiplicative hashing with the golden ratio.
  std::size_t place = (key * 0x9e3779b97f4a7c15) >> shift_;
  while (slots_[place] != kFree && cells_[slots_[place]].key != key) place = (place + 1) & (slots_.size() - 1);
  return &slots_[place];
}

void CellStore::ResizeTable(std::size_t num_slots) {
  if (num_slots != slots_.size()) slots_ = {};  // the old table goes before the new one comes
  slots_.assign(num_slots, kFree);
  shift_ = 64 - std::countr_zero(num_slots);
  for (std::size_t i = 0; i < cells_.size(); ++i) *SlotOf(cells_[i].key) = static_cast<uint32_t>(i);
}

void CellStore::CutRun() {
  const auto median = cells_.begin() + static_cast<std::ptrdiff_t>(cells_.size() / 2);
  std::nth_element(cells_.begin(), median, cells_.end(), HasLessKey);
  end_key_ = median->key;
  cells_.erase(median, cells_.end());
  ResizeTable(slots_.size());
}

}  // namespace curvereg
