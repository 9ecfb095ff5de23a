// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/prepared_scan.h"

#include "core/parallel.h"

namespace curvereg {

PreparedScan::PreparedScan(std::shared_ptr<const Scan> scan, const PreparationOptions& options)
    : scan_(std::move(scan)), options_(options) {
  ParallelFor(2, [this](int task) {
    if (task == 0) {
      free_space_ = FreeSpace(scan_->points, options_.free_space);
    } else {
      voxel_maps_ = BuildVoxelMaps(scan_->points, options_.voxels);
      verticals_ = FindVerticals(voxel_maps_, scan_->gravity, options_.leveling);
    }
  });
  for (const Surfel& surfel : voxel_maps_.front().surfels()) representatives_.push_back(surfel.representative);
  for (size_t i = 0; i < 2 * verticals_.size(); ++i) views_.push_back(std::make_unique<LazyView>());
}

absl::StatusOr<const ViewFeatures*> PreparedScan::View(BirdsEyeView view, size_t vertical) const {
  LazyView& lazy = *views_[2 * vertical + (view == BirdsEyeView::kElevation ? 0 : 1)];
  std::call_once(lazy.once, [&] {
    const ViewOptions& options = view == BirdsEyeView::kElevation ? options_.elevation : options_.occupancy;
    lazy.features = ComputeViewFeatures(scan_->points, verticals_[vertical].R_level_sensor, options);
  });
  if (!lazy.features.ok()) return lazy.features.status();
  return &*lazy.features;
}

const PreparedScan& PreparedScan::Cleaned() const {
  std::call_once(cleaned_once_, [&] {
    auto cleaned = std::make_shared<Scan>();
    cleaned->gravity = scan_->gravity;
    const Eigen::Vector3d up = verticals_.front().R_level_sensor.row(2);
    cleaned->points = RemoveIsolatedReturns(scan_->points, up, options_.isolation);
    PreparationOptions options = options_;
    options.elevation = options_.cleaned_elevation;
    cleaned_ = std::make_unique<PreparedScan>(std::move(cleaned), options);
  });
  return *cleaned_;
}

}  // namespace curvereg
