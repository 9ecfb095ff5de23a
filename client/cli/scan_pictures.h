// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// All that `inspect` shows of one scan: the views, the coefficients, the differences of curvelets and the key points.
#ifndef CURVEREG_CLIENT_CLI_SCAN_PICTURES_H_
#define CURVEREG_CLIENT_CLI_SCAN_PICTURES_H_

#include <cstdint>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "client/files/png_file.h"
#include "core/scan.h"

namespace curvereg::cli {

struct NamedPicture {
  std::string name;  // file name, e.g. "range.png"
  Image<Rgb> picture;
};

struct ScanPictures {
  std::vector<NamedPicture> pictures;
  int64_t num_points = 0;                                  // finite ones
  std::vector<std::pair<std::string, int>> num_keypoints;  // by view
};

// With the options that the methods `paper` (range view) and `curvelet` (bird's-eye views) use by default.
// Precondition: ValidateScan(scan) is OK. CANCELLED, or errors of the stages. Deterministic.
absl::StatusOr<ScanPictures> DrawScan(const Scan& scan, std::stop_token cancellation);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLIENT_CLI_SCAN_PICTURES_H_
