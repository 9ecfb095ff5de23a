// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/prepared_scan.h"

#include "core/base/parallel.h"

namespace curvereg {
namespace {

absl::Status StoppedStatus(const Stop& stop) {
  if (stop.Cancelled()) return absl::CancelledError("registration was cancelled");
  return absl::DeadlineExceededError("time ran out while a scan was prepared");
}

template <typename T>
size_t HeapBytes(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

size_t HeapBytes(const ViewFeatures& view) {
  const Features& features = view.features;
  return HeapBytes(view.image.values.pixels) + HeapBytes(view.image.valid.pixels) + HeapBytes(view.band_pass.pixels) +
         HeapBytes(view.valid.pixels) + HeapBytes(view.slices.slices.pixels) + HeapBytes(features.keypoints) +
         HeapBytes(features.orientations_rad) + HeapBytes(features.descriptors) + HeapBytes(view.planar) +
         HeapBytes(view.heights_m);
}

}  // namespace

PreparedScan::PreparedScan(std::shared_ptr<const Scan> scan, const PreparationOptions& options)
    : scan_(std::move(scan)), options_(options) {}

absl::StatusOr<std::unique_ptr<const PreparedScan>> PreparedScan::Create(std::shared_ptr<const Scan> scan,
                                                                         const PreparationOptions& options,
                                                                         const Stop& stop) {
  if (absl::Status status = ValidateScan(*scan, options.limits, stop); !status.ok()) return status;
  if (stop.Requested()) return StoppedStatus(stop);
  std::unique_ptr<PreparedScan> prepared(new PreparedScan(std::move(scan), options));
  const std::vector<Eigen::Vector3f>& points = prepared->scan_->points;
  ParallelFor(2, [&](int task) {
    if (task == 0) {
      prepared->free_space_ = FreeSpace(points, options.free_space, stop);
    } else {
      prepared->voxel_maps_ = BuildVoxelMaps(points, options.voxels, stop);
      prepared->verticals_ = FindVerticals(prepared->voxel_maps_, prepared->scan_->gravity, options.leveling);
    }
  });
  if (stop.Requested()) return StoppedStatus(stop);
  for (const Surfel& surfel : prepared->voxel_maps_.front().surfels()) {
    prepared->downsampled_points_.push_back(surfel.first_point);
  }
  for (size_t i = 0; i < 2 * prepared->verticals_.size(); ++i) prepared->views_.push_back(std::make_unique<LazyView>());
  return prepared;
}

absl::StatusOr<const ViewFeatures*> PreparedScan::View(BirdsEyeView view, size_t vertical, const Stop& stop) const {
  LazyView& lazy = *views_[2 * vertical + (view == BirdsEyeView::kElevation ? 0 : 1)];
  const std::lock_guard<std::mutex> lock(lazy.mutex);
  if (!lazy.features.has_value()) {
    const ViewOptions& options = view == BirdsEyeView::kElevation ? options_.elevation : options_.occupancy;
    absl::StatusOr<ViewFeatures> features =
        ComputeViewFeatures(scan_->points, verticals_[vertical].R_level_sensor, options, stop);
    if (absl::IsCancelled(features.status())) return StoppedStatus(stop);  // the next caller may have more time
    lazy.features = std::move(features);
    if (lazy.features->ok()) lazy.bytes = HeapBytes(**lazy.features);
  }
  if (!lazy.features->ok()) return lazy.features->status();
  return &**lazy.features;
}

absl::StatusOr<const PreparedScan*> PreparedScan::WithoutOutliers(const Stop& stop) const {
  const std::lock_guard<std::mutex> lock(without_outliers_mutex_);
  if (without_outliers_ == nullptr) {
    auto scan = std::make_shared<Scan>();
    scan->gravity = scan_->gravity;
    const Eigen::Vector3d up = verticals_.front().R_level_sensor.row(2);
    scan->points = RemoveOutliers(scan_->points, up, options_.outlier_removal, stop);
    if (stop.Requested()) return StoppedStatus(stop);
    PreparationOptions options = options_;
    options.elevation = options_.elevation_without_outliers;
    absl::StatusOr<std::unique_ptr<const PreparedScan>> filtered = Create(std::move(scan), options, stop);
    if (!filtered.ok()) return filtered.status();
    without_outliers_ = *std::move(filtered);
    known_without_outliers_ = without_outliers_.get();
  }
  return without_outliers_.get();
}

size_t PreparedScan::MemoryBytes() const {
  size_t bytes = sizeof(PreparedScan) + sizeof(Scan) + HeapBytes(scan_->points) + HeapBytes(voxel_maps_) +
                 HeapBytes(downsampled_points_) + free_space_.MemoryBytes() + HeapBytes(verticals_) + HeapBytes(views_);
  for (const VoxelMap& map : voxel_maps_) bytes += map.MemoryBytes();
  for (const std::unique_ptr<LazyView>& view : views_) bytes += sizeof(LazyView) + view->bytes;
  if (const PreparedScan* filtered = known_without_outliers_; filtered != nullptr) bytes += filtered->MemoryBytes();
  return bytes;
}

}  // namespace curvereg
