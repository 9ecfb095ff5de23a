// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/map_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/stop_status.h"
#include "core/mapping/cell_grid.h"
#include "core/mapping/cell_store.h"
#include "core/mapping/dynamic_removal.h"
#include "core/mapping/tile_index.h"

namespace curvereg {
namespace {

constexpr std::size_t kMinMemoryBytes = std::size_t{1} << 16;
constexpr double kMaxPositionM = 1e7;  // indices of cells stay within 32 bits
constexpr std::size_t kPointsPerQuestion = 65536;
constexpr std::size_t kCellsPerPiece = 8192;
// Of the cells that fit, how many a further pass aims at: what it misses is cut, and done once more.
constexpr double kAim = 0.75;

absl::Status Validate(const MapInput& input, const PointMapOptions& options) {
  if (!(options.cell_m >= 0.01 && options.cell_m <= 10.0)) {
    return absl::InvalidArgumentError("cell_m must be 0.01 to 10");
  }
  if (!(options.max_range_m >= 0.0)) return absl::InvalidArgumentError("max_range_m must not be negative");
  if (options.max_memory_bytes < kMinMemoryBytes) {
    return absl::InvalidArgumentError(absl::StrCat("max_memory_bytes must be at least ", kMinMemoryBytes));
  }
  for (std::size_t i = 0; i < input.T_map_scan.size(); ++i) {
    const RigidTransform& T = input.T_map_scan[i];
    if (!IsRigid(T)) return absl::InvalidArgumentError(absl::StrCat("pose ", i, " is not rigid"));
    if (T.translation().cwiseAbs().maxCoeff() > kMaxPositionM) {
      return absl::InvalidArgumentError(absl::StrCat("pose ", i, " is farther out than ", kMaxPositionM, " m"));
    }
  }
  if (!input.load && !input.T_map_scan.empty()) return absl::InvalidArgumentError("no loader of scans");
  return absl::OkStatus();
}

// Middle of the box about all sensors.
Eigen::Vector3d MiddleOf(const std::vector<RigidTransform>& T_map_scan) {
  if (T_map_scan.empty()) return Eigen::Vector3d::Zero();
  Eigen::AlignedBox3d box;
  for (const RigidTransform& T : T_map_scan) box.extend(Eigen::Vector3d(T.translation()));
  return box.center();
}

// Tiles of at least 4 m and 16 cells per edge: a scan touches some hundreds.
int TileLevel(double cell_m) { return std::max(4, static_cast<int>(std::ceil(std::log2(4.0 / cell_m)))); }

std::size_t MaxCells(const PointMapOptions& options) {
  const std::size_t votes = options.remove_dynamic ? FreeSpaceVotes::kBytesPerCell : 0;
  return options.max_memory_bytes / (CellStore::kBytesPerCell + votes);
}

class MapPasses {
 public:
  MapPasses(const MapInput& input, const PointMapOptions& options, const Stop& stop)
      : input_(input),
        options_(options),
        stop_(stop),
        grid_(options.cell_m, MiddleOf(input.T_map_scan)),
        max_cells_(MaxCells(options)),
        store_(max_cells_),
        tiles_(input.T_map_scan.size(), TileLevel(options.cell_m)) {}

  absl::Status Run(const CellSink& sink) {
    uint64_t begin_key = 0;
    uint64_t end_key = CellGrid::kEndKey;
    while (begin_key < CellGrid::kEndKey) {
      store_.Begin(begin_key, end_key);
      absl::Status status = AddScans(begin_key == 0);
      if (!status.ok()) return status;
      const std::vector<CellSum>& cells = store_.Sort();
      status = Give(cells, sink);
      if (!status.ok()) return status;
      begin_key = store_.end_key();
      if (begin_key < CellGrid::kEndKey) end_key = EndOfNextRun(cells.size());
    }
    return absl::OkStatus();
  }

 private:
  // As dense as the run before.
  uint64_t EndOfNextRun(std::size_t num_cells) {
    const double tiles = static_cast<double>(tiles_.CountTiles(store_.begin_key(), store_.end_key()));
    const double cells_per_tile = std::max(1.0, static_cast<double>(num_cells) / std::max(1.0, tiles));
    const auto wanted = static_cast<std::size_t>(kAim * static_cast<double>(max_cells_) / cells_per_tile);
    return tiles_.EndOfRun(store_.end_key(), wanted, CellGrid::kEndKey);
  }

  absl::StatusOr<std::shared_ptr<const Scan>> Load(std::size_t index) const {
    absl::Status status = StopStatus(stop_, "the map");
    if (!status.ok()) return status;
    absl::StatusOr<std::shared_ptr<const Scan>> scan = input_.load(index, stop_);
    if (scan.ok() && *scan == nullptr) return absl::InvalidArgumentError(absl::StrCat("no scan ", index));
    return scan;
  }

  absl::Status AddScans(bool is_first_pass) {
    for (std::size_t i = 0; i < input_.T_map_scan.size(); ++i) {
      if (!is_first_pass && !tiles_.Touches(i, store_.begin_key(), store_.end_key())) continue;
      const absl::StatusOr<std::shared_ptr<const Scan>> scan = Load(i);
      if (!scan.ok()) return scan.status();
      const absl::Status status = AddPoints(**scan, input_.T_map_scan[i], is_first_pass);
      if (!status.ok()) return status;
      if (is_first_pass) tiles_.EndScan(i);
    }
    return absl::OkStatus();
  }

  absl::Status AddPoints(const Scan& scan, const RigidTransform& T_map_scan, bool is_first_pass) {
    const double max_range_m = options_.max_range_m > 0.0 ? options_.max_range_m : std::numeric_limits<double>::max();
    PlacedPoint placed;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (i % kPointsPerQuestion == 0) {
        absl::Status status = StopStatus(stop_, "the map");
        if (!status.ok()) return status;
      }
      const Eigen::Vector3d point = scan.points[i].cast<double>();
      if (!(point.squaredNorm() <= max_range_m * max_range_m)) continue;
      if (!grid_.Place(T_map_scan * point, &placed)) continue;
      if (is_first_pass) tiles_.AddPoint(placed.key);
      store_.Add(placed);
    }
    return absl::OkStatus();
  }

  // Asks all scans near the cells.
  absl::Status CountVotes(FreeSpaceVotes& votes) const {
    for (std::size_t i = 0; i < input_.T_map_scan.size(); ++i) {
      if (!votes.HasVote(input_.T_map_scan[i])) continue;
      const absl::StatusOr<std::shared_ptr<const Scan>> scan = Load(i);
      if (!scan.ok()) return scan.status();
      votes.AddScan(**scan, input_.T_map_scan[i], stop_);
    }
    return StopStatus(stop_, "the map");
  }

  absl::Status Give(const std::vector<CellSum>& cells, const CellSink& sink) const {
    std::unique_ptr<FreeSpaceVotes> votes;
    if (options_.remove_dynamic) {
      votes = std::make_unique<FreeSpaceVotes>(cells, grid_);
      absl::Status status = CountVotes(*votes);
      if (!status.ok()) return status;
    }
    std::vector<MapCell> piece;
    piece.reserve(kCellsPerPiece);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (votes == nullptr || !votes->IsDynamic(i)) {
        piece.push_back(
            {grid_.IndexOf(cells[i].key).cast<int>(), MeanOf(cells[i], grid_).cast<float>(), cells[i].count});
      }
      if (piece.size() < kCellsPerPiece && i + 1 < cells.size()) continue;
      absl::Status status = StopStatus(stop_, "the map");
      if (status.ok() && !piece.empty()) status = sink(piece);
      if (!status.ok()) return status;
      piece.clear();
    }
    return absl::OkStatus();
  }

  const MapInput& input_;
  const PointMapOptions& options_;
  const Stop& stop_;
  CellGrid grid_;
  std::size_t max_cells_;
  CellStore store_;
  TileIndex tiles_;
};

}  // namespace

absl::Status VisitMapCells(const MapInput& input, const PointMapOptions& options, const CellSink& sink,
                           const Stop& stop) {
  absl::Status status = Validate(input, options);
  if (!status.ok()) return status;
  return MapPasses(input, options, stop).Run(sink);
}

}  // namespace curvereg
