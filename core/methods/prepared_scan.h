// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// All that depends on one scan alone, computed once and reused for every partner: surfels, free space, candidate
// verticals, and per view the features. What the common case needs is computed at once, the rest on first use. Safe to
// share between threads.
#ifndef CURVEREG_CORE_METHODS_PREPARED_SCAN_H_
#define CURVEREG_CORE_METHODS_PREPARED_SCAN_H_

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/features/view_features.h"
#include "core/scan/free_space.h"
#include "core/scan/leveling.h"
#include "core/scan/outlier_removal.h"
#include "core/scan/scan.h"
#include "core/scan/voxel_map.h"

namespace curvereg {

struct PreparationOptions {
  ScanLimits limits;
  VoxelOptions voxels;
  LevelingOptions leveling;
  FreeSpaceOptions free_space;
  ViewOptions elevation = ElevationViewOptions();
  ViewOptions occupancy = OccupancyViewOptions();
  OutlierRemovalOptions outlier_removal;
  ViewOptions elevation_without_outliers = RobustElevationViewOptions();  // of WithoutOutliers()
};

class PreparedScan {
 public:
  // INVALID_ARGUMENT: see ValidateScan. CANCELLED / DEADLINE_EXCEEDED: `stop` was requested meanwhile (it is asked
  // every few milliseconds of work). Uses the threads of the innermost WithThreadLimit.
  static absl::StatusOr<std::unique_ptr<const PreparedScan>> Create(std::shared_ptr<const Scan> scan,
                                                                    const PreparationOptions& options = {},
                                                                    const Stop& stop = {});

  const Scan& scan() const { return *scan_; }
  // Surfels from fine to coarse.
  const std::vector<VoxelMap>& voxel_maps() const { return voxel_maps_; }
  // Voxel-downsampled: one measured point per cell of the finest grid, so that the density is even.
  const std::vector<Eigen::Vector3f>& downsampled_points() const { return downsampled_points_; }
  const FreeSpace& free_space() const { return free_space_; }
  const std::vector<LevelingCandidate>& verticals() const { return verticals_; }

  // The view levelled by verticals()[vertical]; computed by the first caller, who may be one of several at once.
  // Errors as Create.
  absl::StatusOr<const ViewFeatures*> View(BirdsEyeView view, size_t vertical, const Stop& stop = {}) const;

  // The same scan after outlier removal, with robust (median) heights in its elevation view: for scans with many false
  // returns. Computed by the first caller. Errors as Create.
  absl::StatusOr<const PreparedScan*> WithoutOutliers(const Stop& stop = {}) const;

  // Memory that the scan and all that was computed of it hold by now; grows with first uses of View and
  // WithoutOutliers. What is being computed at the moment is not counted. Does not wait for it either.
  size_t MemoryBytes() const;

 private:
  struct LazyView {
    std::mutex mutex;
    std::optional<absl::StatusOr<ViewFeatures>> features;
    std::atomic<size_t> bytes = 0;  // of `features`, readable without the mutex
  };

  PreparedScan(std::shared_ptr<const Scan> scan, const PreparationOptions& options);

  std::shared_ptr<const Scan> scan_;
  PreparationOptions options_;
  std::vector<VoxelMap> voxel_maps_;
  std::vector<Eigen::Vector3f> downsampled_points_;
  FreeSpace free_space_;
  std::vector<LevelingCandidate> verticals_;
  std::vector<std::unique_ptr<LazyView>> views_;  // elevation and occupancy of each vertical
  mutable std::mutex without_outliers_mutex_;
  mutable std::unique_ptr<const PreparedScan> without_outliers_;
  // without_outliers_, readable without the mutex.
  mutable std::atomic<const PreparedScan*> known_without_outliers_ = nullptr;
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_METHODS_PREPARED_SCAN_H_
