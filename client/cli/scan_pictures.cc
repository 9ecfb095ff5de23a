// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/scan_pictures.h"

#include <algorithm>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cli/coefficient_picture.h"
#include "client/cli/stage_pictures.h"
#include "core/curvelet_transform.h"
#include "core/image_conditioning.h"
#include "core/paper_features.h"
#include "core/prepared_scan.h"
#include "core/scale_bands.h"

namespace curvereg::cli {
namespace {

constexpr int kBirdsEyeZoom = 3;
constexpr int kCoefficientPicturePx = 900;

Image<Rgb> GreyAsRgb(const Image<uint8_t>& grey) {
  Image<Rgb> picture(grey.rows, grey.cols);
  for (std::size_t i = 0; i < grey.size(); ++i) picture.pixels[i] = {grey.pixels[i], grey.pixels[i], grey.pixels[i]};
  return picture;
}

// The range image as the method `paper` conditions it: filled, blurred, on [0, 1].
Image<float> ConditionedRange(const RangeImage& image, const PaperFeatureOptions& options) {
  Image<float> values = image.range;
  FillHoles(image.valid, values);
  GaussianBlur3x3(options.blur_sigma_px, values);
  const auto [low, high] = std::minmax_element(values.pixels.begin(), values.pixels.end());
  const float offset = *low;
  const float span = std::max(*high - *low, 1e-12F);
  for (float& value : values.pixels) value = (value - offset) / span;
  return values;
}

absl::Status AddCoefficients(const Image<float>& values, ScanPictures& result) {
  Image<double> image(values.rows, values.cols);
  std::copy(values.pixels.begin(), values.pixels.end(), image.pixels.begin());
  const absl::StatusOr<CurveletTransform> transform =
      CurveletTransform::Create(image.rows, image.cols, {.finest = FinestScale::kCurvelets});
  if (!transform.ok()) return transform.status();
  const absl::StatusOr<ComplexCurvelets> curvelets = transform->ForwardComplex(image);
  if (!curvelets.ok()) return curvelets.status();
  result.pictures.push_back({"coefficients.png", GreyAsRgb(CoefficientPicture(*curvelets, kCoefficientPicturePx))});
  return absl::OkStatus();
}

// Numbered as in the paper: I_DoC(j) = I_c(j) - I_c(j-1), j from 2 on.
absl::Status AddDifferences(const std::string& view, const Image<float>& values, const ScaleBandOptions& bands_options,
                            bool from_above, ScanPictures& result) {
  const absl::StatusOr<std::vector<Image<float>>> bands = ComputeScaleBands(values, bands_options);
  if (!bands.ok()) return bands.status();
  const std::vector<Image<float>> stack = DifferenceOfCurvelets(*bands);
  for (std::size_t level = 1; level < stack.size(); ++level) {
    const Image<Rgb> picture = SignedPicture(stack[level], from_above ? kBirdsEyeZoom : 1);
    result.pictures.push_back(
        {absl::StrCat(view, "_doc_", level + 1, ".png"), from_above ? FlippedRows(picture) : picture});
  }
  return absl::OkStatus();
}

absl::Status AddRangeView(const Scan& scan, ScanPictures& result) {
  const PaperFeatureOptions options;
  const absl::StatusOr<RangeImage> image = ComputeRangeImage(scan.points, options.image);
  if (!image.ok()) return image.status();
  if (image->range.empty()) return absl::InvalidArgumentError("no point away from the sensor");
  const BearingAngleImage bearing = ComputeBearingAngles(*image, scan.points);
  result.pictures.push_back({"range.png", ValuePicture(image->range, image->valid, 2)});
  result.pictures.push_back({"bearing_angle.png", ValuePicture(bearing.angle, bearing.valid, 2)});

  const Image<float> conditioned = ConditionedRange(*image, options);
  absl::Status status = AddCoefficients(conditioned, result);
  if (!status.ok()) return status;
  status = AddDifferences("range", conditioned, {.num_scales = options.num_scales, .windows = WindowShape::kCartesian},
                          false, result);
  if (!status.ok()) return status;
  const absl::StatusOr<PaperFeatures> features = ComputePaperFeatures(scan, options, Stop{});
  if (!features.ok()) return features.status();
  const std::vector<Keypoint>& keypoints = features->features.keypoints;
  result.pictures.push_back({"range_keypoints.png", KeypointPicture(conditioned, keypoints, options.num_scales, 2)});
  result.num_keypoints.emplace_back("range", static_cast<int>(keypoints.size()));
  return absl::OkStatus();
}

absl::Status AddBirdsEyeView(const std::string& name, const PreparedScan& prepared, const ViewOptions& options,
                             ScanPictures& result) {
  const Scan& scan = prepared.scan();
  const Eigen::Matrix3d& R_level_sensor = prepared.verticals().front().R_level_sensor;
  const BirdsEyeImage image = options.view == BirdsEyeView::kElevation
                                  ? ElevationImage(scan.points, R_level_sensor, options.image)
                                  : OccupancyImage(ComputeOccupancySlices(scan.points, R_level_sensor, options.image));
  result.pictures.push_back(
      {absl::StrCat(name, ".png"), FlippedRows(ValuePicture(image.values, image.valid, kBirdsEyeZoom))});

  const absl::StatusOr<const ViewFeatures*> view = prepared.View(options.view, 0);
  if (!view.ok()) return view.status();
  const Image<float>& conditioned = (*view)->image.values;
  Image<float> tapered = conditioned;
  TaperBorder(options.taper_px, tapered);
  const absl::Status status = AddDifferences(name, tapered, options.bands, true, result);
  if (!status.ok()) return status;
  const std::vector<Keypoint>& keypoints = (*view)->features.keypoints;
  result.pictures.push_back(
      {absl::StrCat(name, "_keypoints.png"),
       FlippedRows(KeypointPicture(conditioned, keypoints, options.bands.num_scales, kBirdsEyeZoom))});
  result.num_keypoints.emplace_back(name, static_cast<int>(keypoints.size()));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ScanPictures> DrawScan(const Scan& scan, std::stop_token cancellation) {
  ScanPictures result;
  result.num_points =
      std::count_if(scan.points.begin(), scan.points.end(), [](const auto& p) { return p.allFinite(); });
  absl::Status status = AddRangeView(scan, result);
  if (!status.ok()) return status;
  if (cancellation.stop_requested()) return absl::CancelledError("interrupted");

  const PreparationOptions options;
  const absl::StatusOr<std::unique_ptr<const PreparedScan>> prepared =
      PreparedScan::Create(std::make_shared<Scan>(scan), options, Stop{cancellation, std::nullopt});
  if (!prepared.ok()) return prepared.status();
  status = AddBirdsEyeView("elevation", **prepared, options.elevation, result);
  if (!status.ok()) return status;
  if (cancellation.stop_requested()) return absl::CancelledError("interrupted");
  status = AddBirdsEyeView("occupancy", **prepared, options.occupancy, result);
  if (!status.ok()) return status;
  return result;
}

}  // namespace curvereg::cli
