// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// All that there is to see of one scan: the views, the coefficients, the differences of curvelets and the key points.
#ifndef CURVEREG_RENDER_SCAN_PICTURES_H_
#define CURVEREG_RENDER_SCAN_PICTURES_H_

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/scan/scan.h"
#include "render/png.h"

namespace curvereg {

enum class PictureKind {
  kViews,         // panoramas of range and bearing angle, bird's-eye views of elevation and occupancy
  kCoefficients,  // logarithms of the curvelet coefficients of the range panorama
  kDifferences,   // differences of curvelets of each view, one picture a level
  kKeypoints,     // the views with their key points
};

struct NamedPicture {
  PictureKind kind = PictureKind::kViews;
  std::string name;  // unique, lower_snake_case, e.g. "elevation_doc_2"
  Image<Rgb> picture;
};

struct ScanPictures {
  std::vector<NamedPicture> pictures;                      // in order of the stages
  int64_t num_points = 0;                                  // finite ones
  std::vector<std::pair<std::string, int>> num_keypoints;  // by view; with kKeypoints only
};

// The pictures of these kinds; all of them when there is none. With the options that the methods `paper` (range view)
// and `curvelet` (bird's-eye views) use by default. Precondition: ValidateScan(scan) is OK. CANCELLED,
// DEADLINE_EXCEEDED: `stop` was requested, asked between steps of at most some tens of milliseconds; errors of the
// stages. Deterministic. Uses the threads of the innermost WithThreadLimit.
absl::StatusOr<ScanPictures> DrawScan(const Scan& scan, const std::set<PictureKind>& kinds = {}, const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_RENDER_SCAN_PICTURES_H_
