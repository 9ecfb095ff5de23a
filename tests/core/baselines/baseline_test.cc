// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/baselines/baseline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace curvereg {
namespace {

using ::testing::HasSubstr;

TEST(BaselineTest, DefaultsAreThePapers) {
  const BaselineOptions options;
  EXPECT_TRUE(Validate(options).ok());
  EXPECT_EQ(options.voxel_size_m, 0.0);
  EXPECT_EQ(options.normal_radius_m, 1.0);
  EXPECT_EQ(options.feature_radius_m, 1.0);
  EXPECT_EQ(options.min_sample_distance_m, 2.5);
  EXPECT_EQ(options.icp_max_correspondence_m, 5.0);
  EXPECT_EQ(options.ransac_threshold_m, 15.0);
  EXPECT_EQ(options.correspondence_randomness, 20);
  EXPECT_EQ(options.max_iterations, 100);
  EXPECT_EQ(options.epsilon, 1e-6);
}

TEST(BaselineTest, ResultIsBornWithoutAPose) {
  const BaselineResult result;
  EXPECT_FALSE(result.T_target_source.has_value());
  EXPECT_FALSE(result.converged);
}

template <typename T>
void ExpectRefused(T BaselineOptions::*option, T value, const std::string& name) {
  BaselineOptions options;
  options.*option = value;
  const absl::Status status = Validate(options);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << name << " = " << value;
  EXPECT_THAT(std::string(status.message()), HasSubstr(name));
}

TEST(BaselineTest, NamesTheOptionThatIsOutOfRange) {
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ExpectRefused(&BaselineOptions::voxel_size_m, bad, "voxel_size_m");
    ExpectRefused(&BaselineOptions::normal_radius_m, bad, "normal_radius_m");
    ExpectRefused(&BaselineOptions::feature_radius_m, bad, "feature_radius_m");
    ExpectRefused(&BaselineOptions::min_sample_distance_m, bad, "min_sample_distance_m");
    ExpectRefused(&BaselineOptions::ransac_threshold_m, bad, "ransac_threshold_m");
    ExpectRefused(&BaselineOptions::icp_max_correspondence_m, bad, "icp_max_correspondence_m");
    ExpectRefused(&BaselineOptions::epsilon, bad, "epsilon");
  }
  ExpectRefused(&BaselineOptions::correspondence_randomness, 0, "correspondence_randomness");
  ExpectRefused(&BaselineOptions::max_iterations, 0, "max_iterations");
}

}  // namespace
}  // namespace curvereg
