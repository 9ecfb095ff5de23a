// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/paper_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/stop_status.h"
#include "core/curvelet/scale_bands.h"
#include "core/views/range_conditioning.h"

namespace curvereg {
namespace {

// Columns by which the bands are continued around the circle, so that no key point or descriptor window meets the seam;
// fewer than an image of the coarsest step has.
constexpr int kWrapPx = 24;

// The image with `margin` more columns on either side, taken from the other one. Precondition: margin <= columns.
Image<float> WrappedAround(const Image<float>& image, int margin) {
  Image<float> wrapped(image.rows, image.cols + 2 * margin);
  for (int row = 0; row < image.rows; ++row) {
    const float* in = image.Row(row);
    float* out = std::copy_n(in + image.cols - margin, margin, wrapped.Row(row));
    out = std::copy_n(in, image.cols, out);
    std::copy_n(in, margin, out);
  }
  return wrapped;
}

// Index of the return under a key point of the wrapped image; -1 when the key point belongs to a copy, lies on a filled
// hole or is too near.
int32_t ReturnOf(const Keypoint& keypoint, const RangeImage& image, double min_range_m) {
  const int row = static_cast<int>(std::floor(keypoint.row + 0.5F));
  const int col = static_cast<int>(std::floor(keypoint.col + 0.5F)) - kWrapPx;
  if (!image.range.Contains(row, col) || image.valid(row, col) == 0) return -1;
  return image.range(row, col) < min_range_m ? -1 : image.point(row, col);
}

// Key points with a return of their own, of the images that WrappedAround continued.
std::vector<Keypoint> DetectOnReturns(const std::vector<Image<float>>& bands, const RangeImage& image,
                                      const PaperFeatureOptions& options) {
  const Image<float> all_valid(bands.front().rows, bands.front().cols, 1.0F);
  std::vector<Keypoint> keypoints = DetectKeypoints(DifferenceOfCurvelets(bands), all_valid, options.keypoints);
  std::erase_if(keypoints,
                [&](const Keypoint& keypoint) { return ReturnOf(keypoint, image, options.min_range_m) < 0; });
  return keypoints;
}

}  // namespace

absl::Status Validate(const PaperFeatureOptions& options) {
  if (!(options.blur_sigma_px >= 0.0 && options.blur_sigma_px <= 10.0)) {
    return absl::InvalidArgumentError("paper: the blur is not within 0 to 10 pixels");
  }
  if (!(options.min_range_m >= 0.0) || !std::isfinite(options.min_range_m)) {
    return absl::InvalidArgumentError("paper: the least range of key points is not a length of at least 0");
  }
  return absl::OkStatus();
}

absl::StatusOr<PaperFeatures> ComputePaperFeatures(const Scan& scan, const PaperFeatureOptions& options,
                                                   const Stop& stop) {
  if (absl::Status status = StopStatus(stop, "registration"); !status.ok()) return status;
  absl::StatusOr<RangeImage> image = ComputeRangeImage(scan.points, options.image);
  if (!image.ok()) return image.status();
  if (image->range.empty()) return PaperFeatures{};
  if (absl::Status status = StopStatus(stop, "registration"); !status.ok()) return status;
  absl::StatusOr<std::vector<Image<float>>> bands =
      ComputeScaleBands(ConditionRange(*image, options.blur_sigma_px),
                        {.num_scales = options.num_scales, .windows = WindowShape::kCartesian});
  if (!bands.ok()) return bands.status();
  if (absl::Status status = StopStatus(stop, "registration"); !status.ok()) return status;
  for (Image<float>& band : *bands) band = WrappedAround(band, kWrapPx);
  const std::vector<Keypoint> keypoints = DetectOnReturns(*bands, *image, options);
  PaperFeatures result;
  result.features = DescribeKeypoints(*bands, keypoints, options.descriptors);
  for (Keypoint& keypoint : result.features.keypoints) {
    const int32_t point = ReturnOf(keypoint, *image, options.min_range_m);
    result.points.push_back(scan.points[static_cast<size_t>(point)].cast<double>());
    keypoint.col -= static_cast<float>(kWrapPx);
  }
  return result;
}

}  // namespace curvereg
