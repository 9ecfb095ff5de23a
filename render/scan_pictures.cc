// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/scan_pictures.h"

#include <algorithm>
#include <memory>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/curvelet/curvelet_transform.h"
#include "core/curvelet/scale_bands.h"
#include "core/features/paper_features.h"
#include "core/methods/prepared_scan.h"
#include "core/views/image_conditioning.h"
#include "core/views/range_conditioning.h"
#include "render/coefficient_picture.h"
#include "render/plot.h"
#include "render/stage_pictures.h"

namespace curvereg {
namespace {

constexpr int kBirdsEyeZoom = 3;
constexpr int kRangeZoom = 2;
constexpr int kCoefficientPicturePx = 900;

// How the images of one view are plotted.
struct ViewPlots {
  std::string name;                  // of the files
  std::string title;                 // within a sentence
  std::string quantity;              // what the view's values are, with their unit
  std::string conditioned_quantity;  // the same after conditioning
  std::string difference;            // of conditioned values
  Axis x;
  Axis y;
  int zoom = 1;
  bool has_rows_upward = false;  // row 0 is below
};

ViewPlots RangePlots(const RangeImage& image) {
  const auto degrees = [](double radians) { return radians * 180.0 / std::numbers::pi; };
  return {.name = "range",
          .title = "range panorama",
          .quantity = "range [m]",
          .conditioned_quantity = "range, from 0 (nearest) to 1 (farthest)",
          .difference = "difference [share of the range's span]",
          .x = {.name = "azimuth", .unit = "deg", .first = 180.0, .last = -180.0},
          .y = {.name = "elevation",
                .unit = "deg",
                .first = degrees(image.ElevationOf(image.range.rows - 0.5)),
                .last = degrees(image.ElevationOf(-0.5))},
          .zoom = kRangeZoom};
}

ViewPlots BirdsEyePlots(const ViewOptions& options) {
  const double half_m = 0.5 * options.image.size * options.image.cell_m;
  const bool is_elevation = options.view == BirdsEyeView::kElevation;
  return {
      .name = is_elevation ? "elevation" : "occupancy",
      .title = is_elevation ? "elevation from above" : "occupancy from above",
      .quantity = is_elevation ? "height above the sensor [m]" : "occupied height slices of 0.5 m",
      .conditioned_quantity = is_elevation ? "height above the fitted plane [m]" : "occupied height slices of 0.5 m",
      .difference = is_elevation ? "difference of heights [m]" : "difference [slices of 0.5 m]",
      .x = {.name = "x, levelled", .unit = "m", .first = -half_m, .last = half_m},
      .y = {.name = "y, levelled", .unit = "m", .first = -half_m, .last = half_m},
      .zoom = kBirdsEyeZoom,
      .has_rows_upward = true};
}

// The plot with its axes and texts, as a picture.
Image<Rgb> Finished(Plot plot, const ViewPlots& view, std::string title, std::string quantity) {
  if (view.has_rows_upward) plot.pixels = FlippedRows(plot.pixels);
  plot.title = std::move(title);
  plot.x = view.x;
  plot.y = view.y;
  plot.colour_bar->label = std::move(quantity);
  return FramedPlot(plot);
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
    if (absl::Status status = AddBirdsEyeView(**prepared, options.elevation); !status.ok()) return status;
    if (absl::Status status = AddBirdsEyeView(**prepared, options.occupancy); !status.ok()) return status;
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

  absl::Status AddCoefficients(const Image<float>& values, double step_rad) {
    if (!Wants(PictureKind::kCoefficients)) return absl::OkStatus();
    if (absl::Status status = StopStatus(); !status.ok()) return status;
    Image<double> image(values.rows, values.cols);
    std::copy(values.pixels.begin(), values.pixels.end(), image.pixels.begin());
    const absl::StatusOr<CurveletTransform> transform =
        CurveletTransform::Create(image.rows, image.cols, {.finest = FinestScale::kCurvelets});
    if (!transform.ok()) return transform.status();
    const absl::StatusOr<ComplexCurvelets> curvelets = transform->ForwardComplex(image);
    if (!curvelets.ok()) return curvelets.status();
    Add(PictureKind::kCoefficients, "coefficients",
        FramedPlot(CoefficientPlot(*curvelets, kCoefficientPicturePx, step_rad)));
    return absl::OkStatus();
  }

  // Numbered as in the paper: I_DoC(j) = I_c(j) - I_c(j-1), j from 2 on.
  absl::Status AddDifferences(const ViewPlots& view, const Image<float>& values, const ScaleBandOptions& options) {
    if (!Wants(PictureKind::kDifferences)) return absl::OkStatus();
    if (absl::Status status = StopStatus(); !status.ok()) return status;
    const absl::StatusOr<std::vector<Image<float>>> bands = ComputeScaleBands(values, options);
    if (!bands.ok()) return bands.status();
    const std::vector<Image<float>> stack = DifferenceOfCurvelets(*bands);
    for (std::size_t level = 1; level < stack.size(); ++level) {
      const std::string title = absl::StrCat("Difference of curvelets, level ", level + 1, " minus ", level, ": ");
      Add(PictureKind::kDifferences, absl::StrCat(view.name, "_doc_", level + 1),
          Finished(SignedPlot(stack[level], view.zoom), view, title + view.title, view.difference));
    }
    return absl::OkStatus();
  }

  void AddKeypoints(const ViewPlots& view, const Image<float>& values, const std::vector<Keypoint>& keypoints,
                    int num_scales) {
    Add(PictureKind::kKeypoints, absl::StrCat(view.name, "_keypoints"),
        Finished(KeypointPlot(values, keypoints, num_scales, view.zoom), view,
                 absl::StrCat(keypoints.size(), " key points: ", view.title), view.conditioned_quantity));
    result_.num_keypoints.emplace_back(view.name, static_cast<int>(keypoints.size()));
  }

  void AddRangeViews(const RangeImage& image, const ViewPlots& view) {
    if (!Wants(PictureKind::kViews)) return;
    const BearingAngleImage bearing = ComputeBearingAngles(image, scan_.points);
    Add(PictureKind::kViews, "range",
        Finished(ValuePlot(image.range, image.valid, view.zoom), view, "Range panorama", view.quantity));
    Add(PictureKind::kViews, "bearing_angle",
        Finished(ValuePlot(bearing.angle, bearing.valid, view.zoom), view, "Bearing angle panorama",
                 "bearing angle [rad]"));
  }

  absl::Status AddRangeView() {
    const PaperFeatureOptions options;
    const absl::StatusOr<RangeImage> image = ComputeRangeImage(scan_.points, options.image);
    if (!image.ok()) return image.status();
    if (image->range.empty()) return absl::InvalidArgumentError("no point away from the sensor");
    const ViewPlots view = RangePlots(*image);
    AddRangeViews(*image, view);
    const Image<float> conditioned = ConditionRange(*image, options.blur_sigma_px);
    if (absl::Status status = AddCoefficients(conditioned, image->step_rad); !status.ok()) return status;
    const ScaleBandOptions bands = {.num_scales = options.num_scales, .windows = WindowShape::kCartesian};
    if (absl::Status status = AddDifferences(view, conditioned, bands); !status.ok()) return status;
    if (!Wants(PictureKind::kKeypoints)) return absl::OkStatus();
    const absl::StatusOr<PaperFeatures> features = ComputePaperFeatures(scan_, options, stop_);
    if (!features.ok()) return features.status();
    AddKeypoints(view, conditioned, features->features.keypoints, options.num_scales);
    return absl::OkStatus();
  }

  void AddBirdsEyeImage(const ViewPlots& view, const Eigen::Matrix3d& R_level_sensor, const ViewOptions& options) {
    if (!Wants(PictureKind::kViews)) return;
    const BirdsEyeImage image =
        options.view == BirdsEyeView::kElevation
            ? ElevationImage(scan_.points, R_level_sensor, options.image)
            : OccupancyImage(ComputeOccupancySlices(scan_.points, R_level_sensor, options.image));
    const std::string title =
        options.view == BirdsEyeView::kElevation ? "Elevation from above" : "Occupancy from above";
    Add(PictureKind::kViews, view.name,
        Finished(ValuePlot(image.values, image.valid, view.zoom), view, title, view.quantity));
  }

  absl::Status AddBirdsEyeView(const PreparedScan& prepared, const ViewOptions& options) {
    if (absl::Status status = StopStatus(); !status.ok()) return status;
    const ViewPlots view = BirdsEyePlots(options);
    AddBirdsEyeImage(view, prepared.verticals().front().R_level_sensor, options);
    if (!Wants(PictureKind::kDifferences) && !Wants(PictureKind::kKeypoints)) return absl::OkStatus();
    const absl::StatusOr<const ViewFeatures*> features = prepared.View(options.view, 0, stop_);
    if (!features.ok()) return features.status();
    const Image<float>& conditioned = (*features)->image.values;
    Image<float> tapered = conditioned;
    Apodize(options.taper_px, tapered);
    if (absl::Status status = AddDifferences(view, tapered, options.bands); !status.ok()) return status;
    if (!Wants(PictureKind::kKeypoints)) return absl::OkStatus();
    AddKeypoints(view, conditioned, (*features)->features.keypoints, options.bands.num_scales);
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
