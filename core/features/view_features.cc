// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/view_features.h"

#include <algorithm>
#include <cmath>

#include "core/views/image_conditioning.h"

namespace curvereg {
namespace {

BirdsEyeImage MakeImage(const std::vector<Eigen::Vector3f>& points, const Eigen::Matrix3d& R_level_sensor,
                        const ViewOptions& options, const Stop& stop, OccupancySlices& slices) {
  if (options.view == BirdsEyeView::kElevation) return ElevationImage(points, R_level_sensor, options.image, stop);
  slices = ComputeOccupancySlices(points, R_level_sensor, options.image, stop);
  return OccupancyImage(slices);
}

// Height of the unconditioned image at the nearest valid pixel around the key point.
double HeightAt(const Image<float>& heights, const Keypoint& keypoint) {
  const int row = std::clamp(static_cast<int>(std::lround(keypoint.row)), 0, heights.rows - 1);
  const int col = std::clamp(static_cast<int>(std::lround(keypoint.col)), 0, heights.cols - 1);
  return heights(row, col);
}

}  // namespace

ViewOptions ElevationViewOptions() {
  ViewOptions options;
  options.image.cell_m = 0.5;
  return options;
}

ViewOptions OccupancyViewOptions() {
  ViewOptions options;
  options.view = BirdsEyeView::kOccupancy;
  options.image.cell_m = 0.4;
  options.keypoints.min_response = 0.05;
  options.keypoints.min_valid_fraction = 0.0;
  return options;
}

ViewOptions RobustElevationViewOptions() {
  ViewOptions options = ElevationViewOptions();
  options.image.median = true;
  options.max_spike_m = 0.12;
  return options;
}

absl::StatusOr<ViewFeatures> ComputeViewFeatures(const std::vector<Eigen::Vector3f>& points,
                                                 const Eigen::Matrix3d& R_level_sensor, const ViewOptions& options,
                                                 const Stop& stop) {
  const absl::Status stopped = absl::CancelledError("a view was not completed");
  ViewFeatures result;
  result.R_level_sensor = R_level_sensor;
  result.image = MakeImage(points, R_level_sensor, options, stop, result.slices);
  if (stop.Requested()) return stopped;
  if (options.view == BirdsEyeView::kElevation && options.max_spike_m > 0.0) {
    RemoveSpikes(options.spike_radius_px, static_cast<float>(options.max_spike_m), result.image.values,
                 result.image.valid);
  }
  result.valid = result.image.valid;
  Image<float> filled;
  if (options.view == BirdsEyeView::kElevation) {
    FillHoles(result.image.valid, result.image.values);
    filled = result.image.values;
    Detrend(result.image.valid, result.image.values);
  }
  GaussianBlur3x3(options.blur_sigma_px, result.image.values);
  Image<float> tapered = result.image.values;
  Apodize(options.taper_px, tapered);
  absl::StatusOr<std::vector<Image<float>>> bands = ComputeScaleBands(tapered, options.bands);
  if (!bands.ok()) return bands.status();
  if (stop.Requested()) return stopped;
  const std::vector<Image<float>> doc_stack = DifferenceOfCurvelets(*bands);
  const std::vector<Keypoint> keypoints = DetectKeypoints(doc_stack, ValidFraction(result.valid, 4), options.keypoints);
  if (stop.Requested()) return stopped;
  result.features = DescribeKeypoints(*bands, keypoints, options.descriptors);
  for (size_t i = 0; i < result.features.size(); ++i) {
    const Keypoint& keypoint = result.features.keypoints[i];
    result.planar.push_back({result.image.PositionOf(keypoint.row, keypoint.col), result.features.orientations_rad[i]});
    if (!filled.empty()) result.heights_m.push_back(HeightAt(filled, keypoint));
  }
  result.band_pass = (*bands)[1];
  for (size_t j = 2; j + 1 < bands->size(); ++j) {
    for (size_t i = 0; i < result.band_pass.size(); ++i) result.band_pass.pixels[i] += (*bands)[j].pixels[i];
  }
  return result;
}

}  // namespace curvereg
