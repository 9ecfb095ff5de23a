// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which tiles of the map each scan has points in, so that a pass over a part of the map asks for few scans.
#ifndef CURVEREG_CORE_MAPPING_TILE_INDEX_H_
#define CURVEREG_CORE_MAPPING_TILE_INDEX_H_

#include <cstddef>
#include <cstdint>
#include <vector>

namespace curvereg {

class TileIndex {
 public:
  // Scans with points in more tiles than this (strewn far and wide) count as touching everything: bounded memory.
  static constexpr std::size_t kMaxTilesPerScan = 4096;

  // Tiles of 2^level cells per edge.
  TileIndex(std::size_t num_scans, int level) : shift_(3 * level), tiles_(num_scans) {}

  // Call for each point of one scan after the other (keys of CellGrid), then EndScan.
  void AddPoint(uint64_t key) {
    const uint64_t tile = key >> shift_;
    if (!current_.empty() && current_.back() == tile) return;
    current_.push_back(tile);
    if (current_.size() == 4 * kMaxTilesPerScan) Compact();
  }
  void EndScan(std::size_t scan);

  // Whether the scan may have points with keys in [begin_key, end_key).
  bool Touches(std::size_t scan, uint64_t begin_key, uint64_t end_key) const;
  // Tiles with keys in [begin_key, end_key) that some scan has points in.
  std::size_t CountTiles(uint64_t begin_key, uint64_t end_key);
  // End of the run from `begin_key` on that holds this many tiles (at least one), at most `last_key`.
  uint64_t EndOfRun(uint64_t begin_key, std::size_t num_tiles, uint64_t last_key);

 private:
  struct ScanTiles {
    bool everything = false;
    std::vector<uint64_t> tiles;  // increasing
  };
  void Compact();
  const std::vector<uint64_t>& AllTiles();

  int shift_;
  std::vector<ScanTiles> tiles_;
  std::vector<uint64_t> current_;  // of the scan under way
  bool current_everything_ = false;
  std::vector<uint64_t> all_;  // of all scans, increasing
  bool all_known_ = false;
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_TILE_INDEX_H_
