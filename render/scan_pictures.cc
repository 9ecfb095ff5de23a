// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/scan_pictures.h"

#include <algorithm>
#include <memory>

#include "absl/strings/str_cat.h"
#include "core/curvelet/curvelet_transform.h"
#include "core/curvelet/scale_bands.h"
#include "core/features/paper_features.h"
#include "core/methods/prepared_scan.h"
#include "core/views/image_conditioning.h"
#include "render/coefficient_picture.h"
#include "render/stage_pictures.h"

namespace curvereg {
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

// One drawing of one scan: what is wanted, and what is there so far.
class Drawing {
 public:
  Drawing(const Scan& scan, const std::set<PictureKind>& kinds, const Stop& stop)
      : scan_(scan), kinds_(kinds), stop_(stop) {}

  absl::StatusOr<ScanPictures> Draw() && {
    result_.num_points = CountFinitePoints(scan_);
    if (absl::Status status = AddRangeView(); !status.ok()) return status;
    if (!Wants(PictureKind::kViews) && !Wants(PictureKind::kDifferences) && !Wants(PictureKind::kKeypoints)) {
      return std::move(result_);
    }
    const PreparationOptions options;
    const std::shared_ptr<const Scan> scan(std::shared_ptr<void>(), &scan_);  // not owning: it outlives this call
    const absl::StatusOr<std::unique_ptr<const PreparedScan>> prepared = PreparedScan::Create(scan, options, stop_);
    if (!prepared.ok()) return prepared.status();
    if (absl::Status status = AddBirdsEyeView("elevation", **prepared, options.elevation); !status.ok()) return status;
    if (absl::Status status = AddBirdsEyeView("occupancy", **prepared, options.occupancy); !status.ok()) return status;
    return std::move(result_);
  }

 private:
  bool Wants(PictureKind kind) const { return kinds_.empty() || kinds_.contains(kind); }

  void Add(PictureKind kind, std::string name, Image<Rgb> picture) {
    result_.pictures.push_back({kind, std::move(name), std::move(picture)});
  }

  absl::Status StopStatus() const {
    if (stop_.Cancelled()) return absl::CancelledError("interrupted");
    if (stop_.PastDeadline()) return absl::DeadlineExceededError("time ran out while pictures were drawn");
    return absl::OkStatus();
  }

  absl::Status AddCoefficients(const Image<float>& values) {
    if (!Wants(PictureKind::kCoefficients)) return absl::OkStatus();
    if (absl::Status status = StopStatus(); !status.ok()) return status;
    Image<double> image(values.rows, values.cols);
    std::copy(values.pixels.begin(), values.pixels.end(), image.pixels.begin());
    const absl::StatusOr<CurveletTransform> transform =
        CurveletTransform::Create(image.rows, image.cols, {.finest = FinestScale::kCurvelets});
    if (!transform.ok()) return transform.status();
    const absl::StatusOr<ComplexCurvelets> curvelets = transform->ForwardComplex(image);
    if (!curvelets.ok()) return curvelets.status();
    Add(PictureKind::kCoefficients, "coefficients", GreyAsRgb(CoefficientPicture(*curvelets, kCoefficientPicturePx)));
    return absl::OkStatus();
  }

  // Numbered as in the paper: I_DoC(j) = I_c(j) - I_c(j-1), j from 2 on.
  absl::Status AddDifferences(const std::string& view, const Image<float>& values, const ScaleBandOptions& options) {
    if (!Wants(PictureKind::kDifferences)) return absl::OkStatus();
    if (absl::Status status = StopStatus(); !status.ok()) return status;
    const absl::StatusOr<std::vector<Image<float>>> bands = ComputeScaleBands(values, options);
    if (!bands.ok()) return bands.status();
    const std::vector<Image<float>> stack = DifferenceOfCurvelets(*bands);
    const bool from_above = view != "range";
    for (std::size_t level = 1; level < stack.size(); ++level) {
      Image<Rgb> picture = SignedPicture(stack[level], from_above ? kBirdsEyeZoom : 1);
      if (from_above) picture = FlippedRows(picture);
      Add(PictureKind::kDifferences, absl::StrCat(view, "_doc_", level + 1), std::move(picture));
    }
    return absl::OkStatus();
  }

  absl::Status AddRangeView() {
    const PaperFeatureOptions options;
    const absl::StatusOr<RangeImage> image = ComputeRangeImage(scan_.points, options.image);
    if (!image.ok()) return image.status();
    if (image->range.empty()) return absl::InvalidArgumentError("no point away from the sensor");
    if (Wants(PictureKind::kViews)) {
      const BearingAngleImage bearing = ComputeBearingAngles(*image, scan_.points);
      Add(PictureKind::kViews, "range", ValuePicture(image->range, image->valid, 2));
      Add(PictureKind::kViews, "bearing_angle", ValuePicture(bearing.angle, bearing.valid, 2));
    }
    const Image<float> conditioned = ConditionedRange(*image, options);
    if (absl::Status status = AddCoefficients(conditioned); !status.ok()) return status;
    const ScaleBandOptions bands = {.num_scales = options.num_scales, .windows = WindowShape::kCartesian};
    if (absl::Status status = AddDifferences("range", conditioned, bands); !status.ok()) return status;
    if (!Wants(PictureKind::kKeypoints)) return absl::OkStatus();
    const absl::StatusOr<PaperFeatures> features = ComputePaperFeatures(scan_, options, stop_);
    if (!features.ok()) return features.status();
    const std::vector<Keypoint>& keypoints = features->features.keypoints;
    Add(PictureKind::kKeypoints, "range_keypoints", KeypointPicture(conditioned, keypoints, options.num_scales, 2));
    result_.num_keypoints.emplace_back("range", static_cast<int>(keypoints.size()));
    return absl::OkStatus();
  }

  absl::Status AddBirdsEyeView(const std::string& name, const PreparedScan& prepared, const ViewOptions& options) {
    if (absl::Status status = StopStatus(); !status.ok()) return status;
    if (Wants(PictureKind::kViews)) {
      const Eigen::Matrix3d& R_level_sensor = prepared.verticals().front().R_level_sensor;
      const BirdsEyeImage image =
          options.view == BirdsEyeView::kElevation
              ? ElevationImage(scan_.points, R_level_sensor, options.image)
              : OccupancyImage(ComputeOccupancySlices(scan_.points, R_level_sensor, options.image));
      Add(PictureKind::kViews, name, FlippedRows(ValuePicture(image.values, image.valid, kBirdsEyeZoom)));
    }
    if (!Wants(PictureKind::kDifferences) && !Wants(PictureKind::kKeypoints)) return absl::OkStatus();
    const absl::StatusOr<const ViewFeatures*> view = prepared.View(options.view, 0, stop_);
    if (!view.ok()) return view.status();
    const Image<float>& conditioned = (*view)->image.values;
    Image<float> tapered = conditioned;
    Apodize(options.taper_px, tapered);
    if (absl::Status status = AddDifferences(name, tapered, options.bands); !status.ok()) return status;
    if (!Wants(PictureKind::kKeypoints)) return absl::OkStatus();
    const std::vector<Keypoint>& keypoints = (*view)->features.keypoints;
    Add(PictureKind::kKeypoints, absl::StrCat(name, "_keypoints"),
        FlippedRows(KeypointPicture(conditioned, keypoints, options.bands.num_scales, kBirdsEyeZoom)));
    result_.num_keypoints.emplace_back(name, static_cast<int>(keypoints.size()));
    return absl::OkStatus();
  }

  const Scan& scan_;
  const std::set<PictureKind>& kinds_;
  const Stop& stop_;
  ScanPictures result_;
};

}  // namespace

absl::StatusOr<ScanPictures> DrawScan(const Scan& scan, const std::set<PictureKind>& kinds, const Stop& stop) {
  return Drawing(scan, kinds, stop).Draw();
}

}  // namespace curvereg
