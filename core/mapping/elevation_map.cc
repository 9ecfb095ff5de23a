// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/elevation_map.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <unordered_map>

#include "absl/strings/str_cat.h"
#include "core/mapping/map_cells.h"

namespace curvereg {
namespace {

constexpr int kTileEdge = 16;  // columns
constexpr float kNoData = -9999.0F;

// Columns in square tiles, those that hold something.
class Columns {
 public:
  explicit Columns(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  absl::Status Add(const MapCell& cell) {
    const int tile_x = FloorDivide(cell.index.x());
    const int tile_y = FloorDivide(cell.index.y());
    const uint64_t key = uint64_t{static_cast<uint32_t>(tile_x)} << 32 | static_cast<uint32_t>(tile_y);
    std::unique_ptr<Tile>& tile = tiles_[key];
    if (tile == nullptr) {
      if (num_bytes() > max_bytes_ / 2) return absl::ResourceExhaustedError(TooLarge());
      tile = std::make_unique<Tile>();
    }
    Column& column = (*tile)[static_cast<std::size_t>((cell.index.y() - tile_y * kTileEdge) * kTileEdge +
                                                      cell.index.x() - tile_x * kTileEdge)];
    column.sum += static_cast<double>(cell.mean.z()) * cell.count;
    column.count += cell.count;
    min_ = min_.cwiseMin(cell.index.head<2>());
    max_ = max_.cwiseMax(cell.index.head<2>());
    return absl::OkStatus();
  }

  absl::StatusOr<ElevationMap> Grid(double cell_m) const {
    ElevationMap map;
    map.cell_m = cell_m;
    if (tiles_.empty()) return map;
    const int64_t num_columns = int64_t{max_.x()} - min_.x() + 1;
    const int64_t num_rows = int64_t{max_.y()} - min_.y() + 1;
    const double grid_bytes = static_cast<double>(num_columns) * static_cast<double>(num_rows) * sizeof(float);
    if (grid_bytes + static_cast<double>(num_bytes()) > static_cast<double>(max_bytes_)) {
      return absl::ResourceExhaustedError(
          absl::StrCat("a grid of ", num_columns, " x ", num_rows, " cells; ", TooLarge()));
    }
    map.min_x_m = min_.x() * cell_m;
    map.min_y_m = min_.y() * cell_m;
    map.num_columns = static_cast<int>(num_columns);
    map.num_rows = static_cast<int>(num_rows);
    map.heights.assign(static_cast<std::size_t>(num_columns * num_rows), std::numeric_limits<float>::quiet_NaN());
    for (const auto& [key, tile] : tiles_) Fill(static_cast<int>(key >> 32), static_cast<int>(key), *tile, map);
    return map;
  }

 private:
  struct Column {
    double sum = 0.0;  // of heights [m]
    uint64_t count = 0;
  };
  using Tile = std::array<Column, kTileEdge * kTileEdge>;

  static int FloorDivide(int index) { return (index - (index < 0 ? kTileEdge - 1 : 0)) / kTileEdge; }
  static std::string TooLarge() {
    return "the grid needs more memory than it may have: larger cells or a shorter range";
  }
  std::size_t num_bytes() const { return tiles_.size() * (sizeof(Tile) + 64); }

  void Fill(int tile_x, int tile_y, const Tile& tile, ElevationMap& map) const {
    for (int i = 0; i < kTileEdge * kTileEdge; ++i) {
      const Column& column = tile[static_cast<std::size_t>(i)];
      if (column.count == 0) continue;
      const int64_t x = tile_x * kTileEdge + i % kTileEdge - min_.x();
      const int64_t y = tile_y * kTileEdge + i / kTileEdge - min_.y();
      map.heights[static_cast<std::size_t>((map.num_rows - 1 - y) * map.num_columns + x)] =
          static_cast<float>(column.sum / static_cast<double>(column.count));
    }
  }

  std::size_t max_bytes_;
  std::unordered_map<uint64_t, std::unique_ptr<Tile>> tiles_;
  Eigen::Vector2i min_ = Eigen::Vector2i::Constant(std::numeric_limits<int>::max());
  Eigen::Vector2i max_ = Eigen::Vector2i::Constant(std::numeric_limits<int>::min());
};

// Whatever the locale says.
void AppendNumber(std::string& text, double number, int num_decimals) {
  std::array<char, 64> digits;
  const std::to_chars_result result =
      std::to_chars(digits.data(), digits.data() + digits.size(), number, std::chars_format::fixed, num_decimals);
  text.append(digits.data(), result.ptr);
}

}  // namespace

absl::StatusOr<ElevationMap> BuildElevationMap(const MapInput& input, const PointMapOptions& options,
                                               const Stop& stop) {
  PointMapOptions cell_options = options;
  cell_options.max_memory_bytes = options.max_memory_bytes / 2;
  Columns columns(options.max_memory_bytes);
  const CellSink add = [&](std::span<const MapCell> cells) {
    for (const MapCell& cell : cells) {
      absl::Status status = columns.Add(cell);
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  };
  const absl::Status status = VisitMapCells(input, cell_options, add, stop);
  if (!status.ok()) return status;
  return columns.Grid(options.cell_m);
}

absl::Status WriteEsriAscii(const ElevationMap& map, const TextSink& sink) {
  std::string text = absl::StrCat("ncols ", map.num_columns, "\nnrows ", map.num_rows, "\nxllcorner ");
  AppendNumber(text, map.min_x_m, 6);
  text += "\nyllcorner ";
  AppendNumber(text, map.min_y_m, 6);
  text += "\ncellsize ";
  AppendNumber(text, map.cell_m, 6);
  text += "\nNODATA_value -9999\n";
  for (int row = 0; row < map.num_rows; ++row) {
    const float* heights = map.heights.data() + static_cast<std::ptrdiff_t>(row) * map.num_columns;
    for (int column = 0; column < map.num_columns; ++column) {
      const bool is_seen = std::isfinite(heights[column]);
      AppendNumber(text, static_cast<double>(is_seen ? heights[column] : kNoData), is_seen ? 4 : 0);
      text += column + 1 < map.num_columns ? ' ' : '\n';
    }
    const absl::Status status = sink(text);
    if (!status.ok()) return status;
    text.clear();
  }
  return text.empty() ? absl::OkStatus() : sink(text);
}

}  // namespace curvereg
