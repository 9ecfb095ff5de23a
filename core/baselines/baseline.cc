// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/baselines/baseline.h"

#include <cmath>

#include "absl/strings/str_cat.h"

namespace curvereg {

absl::Status Validate(const BaselineOptions& options) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  const char* wrong = nullptr;
  if (!std::isfinite(options.voxel_size_m) || options.voxel_size_m < 0.0) wrong = "voxel_size_m";
  if (!positive(options.normal_radius_m)) wrong = "normal_radius_m";
  if (!positive(options.feature_radius_m)) wrong = "feature_radius_m";
  if (!std::isfinite(options.min_sample_distance_m) || options.min_sample_distance_m < 0.0) {
    wrong = "min_sample_distance_m";
  }
  if (options.correspondence_randomness < 1) wrong = "correspondence_randomness";
  if (!positive(options.ransac_threshold_m)) wrong = "ransac_threshold_m";
  if (!positive(options.icp_max_correspondence_m)) wrong = "icp_max_correspondence_m";
  if (options.max_iterations < 1) wrong = "max_iterations";
  if (!positive(options.epsilon) || options.epsilon >= 1.0) wrong = "epsilon";
  if (wrong == nullptr) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("baseline option ", wrong, " is out of range"));
}

}  // namespace curvereg
