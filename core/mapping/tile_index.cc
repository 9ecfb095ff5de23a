// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/tile_index.h"

#include <algorithm>

namespace curvereg {
namespace {

void SortUnique(std::vector<uint64_t>& tiles) {
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
}

}  // namespace

void TileIndex::Compact() {
  SortUnique(current_);
  if (current_.size() <= kMaxTilesPerScan) return;
  current_everything_ = true;
  current_.clear();
}

void TileIndex::EndScan(std::size_t scan) {
  Compact();
  tiles_[scan].everything = current_everything_;
  if (!current_everything_) tiles_[scan].tiles.assign(current_.begin(), current_.end());
  current_.clear();
  current_everything_ = false;
  all_known_ = false;
}

bool TileIndex::Touches(std::size_t scan, uint64_t begin_key, uint64_t end_key) const {
  const ScanTiles& of_scan = tiles_[scan];
  if (of_scan.everything) return true;
  const auto tile = std::lower_bound(of_scan.tiles.begin(), of_scan.tiles.end(), begin_key >> shift_);
  return tile != of_scan.tiles.end() && *tile << shift_ < end_key;
}

std::size_t TileIndex::CountTiles(uint64_t begin_key, uint64_t end_key) {
  const std::vector<uint64_t>& all = AllTiles();
  const auto begin = std::lower_bound(all.begin(), all.end(), begin_key >> shift_);
  const auto end = std::lower_bound(begin, all.end(), ((end_key - 1) >> shift_) + 1);
  return static_cast<std::size_t>(end - begin);
}

uint64_t TileIndex::EndOfRun(uint64_t begin_key, std::size_t num_tiles, uint64_t last_key) {
  const std::vector<uint64_t>& all = AllTiles();
  const auto begin = std::lower_bound(all.begin(), all.end(), begin_key >> shift_);
  const std::size_t wanted = std::max<std::size_t>(num_tiles, 1);
  if (static_cast<std::size_t>(all.end() - begin) <= wanted) return last_key;
  return std::min(last_key, *(begin + static_cast<std::ptrdiff_t>(wanted)) << shift_);
}

const std::vector<uint64_t>& TileIndex::AllTiles() {
  if (all_known_) return all_;
  all_.clear();
  std::size_t num_unique = 0;
  for (const ScanTiles& of_scan : tiles_) {
    all_.insert(all_.end(), of_scan.tiles.begin(), of_scan.tiles.end());
    // Neighbouring scans share most tiles.
    if (all_.size() < 2 * num_unique + 16 * kMaxTilesPerScan) continue;
    SortUnique(all_);
    num_unique = all_.size();
  }
  SortUnique(all_);
  all_known_ = true;
  return all_;
}

}  // namespace curvereg
