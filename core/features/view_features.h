// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One bird's-eye view of one scan, from points to features:
// view -> conditioning -> scale bands -> difference of curvelets -> key points -> descriptors.
#ifndef CURVEREG_CORE_FEATURES_VIEW_FEATURES_H_
#define CURVEREG_CORE_FEATURES_VIEW_FEATURES_H_

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/curvelet/scale_bands.h"
#include "core/features/descriptors.h"
#include "core/features/keypoints.h"
#include "core/features/planar_feature.h"
#include "core/views/scan_image.h"

namespace curvereg {

enum class BirdsEyeView { kElevation, kOccupancy };

struct ViewOptions {
  BirdsEyeView view = BirdsEyeView::kElevation;
  BirdsEyeOptions image;
  int spike_radius_px = 2;   // elevation: window that a cell's height is compared with,
  double max_spike_m = 0.0;  // and by how much it may stand out; 0: no comparison (clean scans)
  double blur_sigma_px = 0.5;
  int taper_px = 16;
  ScaleBandOptions bands;
  KeypointOptions keypoints;
  DescriptorOptions descriptors;
};

// The defaults that were measured best for terrain and for structured scenes.
ViewOptions ElevationViewOptions();
ViewOptions OccupancyViewOptions();
// For scans with false returns: median heights, cells that stand out removed.
ViewOptions RobustElevationViewOptions();

struct ViewFeatures {
  Eigen::Matrix3d R_level_sensor = Eigen::Matrix3d::Identity();
  BirdsEyeImage image;     // conditioned (elevation: filled, detrended) before the transform
  Image<float> band_pass;  // sum of the bands that carry features: what verification correlates
  Image<uint8_t> valid;    // where returns fell
  OccupancySlices slices;  // occupancy view only
  Features features;
  std::vector<PlanarFeature> planar;  // the features on the levelled ground, same order
  std::vector<double> heights_m;      // elevation view only: levelled height of each feature
};

// INVALID_ARGUMENT: options out of range (see ScaleBands::Create). CANCELLED: `stop` was requested meanwhile, for
// whatever cause. A scan without points gives no features.
absl::StatusOr<ViewFeatures> ComputeViewFeatures(const std::vector<Eigen::Vector3f>& points,
                                                 const Eigen::Matrix3d& R_level_sensor, const ViewOptions& options,
                                                 const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_FEATURES_VIEW_FEATURES_H_
