// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/baselines/register_baseline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using testing::HasCode;
using testing::IsOk;

constexpr Method kBaselines[] = {Method::kFpfhSacIa, Method::kHarris3dFpfh};

// Sparse, so that the baselines need a second, not a minute.
Scan SparseGround(double x, uint64_t noise_seed) {
  testing::ScannerOptions scanner;
  scanner.num_columns = 120;
  scanner.num_rows = 24;
  scanner.noise_seed = noise_seed;
  return testing::BumpyGround(testing::RoverPose(x, 0.0, 0.1 * x), scanner);
}

RegistrationOptions With(Method method) {
  RegistrationOptions options;
  options.method = method;
  return options;
}

class RegisterBaselineTest : public ::testing::TestWithParam<Method> {
 protected:
  void SetUp() override {
    const auto result = RegisterBaseline(SparseGround(0.0, 1), SparseGround(0.0, 1), With(GetParam()), {});
    if (absl::IsUnimplemented(result.status())) GTEST_SKIP() << result.status();
  }
};

TEST_P(RegisterBaselineTest, AnswersWithPoseAndCounts) {
  const auto result = RegisterBaseline(SparseGround(0.3, 1), SparseGround(0.0, 2), With(GetParam()), {});
  ASSERT_THAT(result, IsOk());
  EXPECT_EQ(result->verdict.accepted, result->verdict.reasons.empty());
  EXPECT_TRUE(result->T_target_source.has_value() || !result->verdict.accepted);
  EXPECT_TRUE(IsRigid(result->T_target_source.value_or(RigidTransform::Identity())));
  EXPECT_FALSE(result->covariance.has_value());
  EXPECT_GT(result->evidence.num_source_keypoints, 0);
  EXPECT_EQ(result->evidence.num_hypotheses, 1);
  EXPECT_FALSE(result->evidence.overlap_source.has_value());  // not a measure of this method
  ASSERT_EQ(result->stage_times.size(), 1U);
  EXPECT_GT(result->stage_times[0].seconds, 0.0);
}

TEST_P(RegisterBaselineTest, SameSeedSameBytes) {
  const auto run = [](uint64_t seed) {
    RegistrationOptions options = With(GetParam());
    options.seed = seed;
    return RegisterBaseline(SparseGround(0.3, 1), SparseGround(0.0, 2), options, {})
        ->T_target_source.value_or(RigidTransform::Identity());
  };
  EXPECT_EQ(run(5).matrix(), run(5).matrix());
}

TEST_P(RegisterBaselineTest, TooFewFeaturesIsARejection) {
  Scan scattered;  // farther apart than any neighbourhood reaches
  for (int i = 0; i < 400; ++i) {
    scattered.points.emplace_back(5.0F * static_cast<float>(i % 20), 5.0F * static_cast<float>(i / 20), 0.0F);
  }
  const auto result = RegisterBaseline(scattered, scattered, With(GetParam()), {});
  ASSERT_THAT(result, IsOk());
  EXPECT_FALSE(result->T_target_source.has_value());
  EXPECT_FALSE(result->verdict.accepted);
  EXPECT_THAT(result->verdict.reasons, ElementsAre(Reason::kTooFewFeatures));
}

TEST_P(RegisterBaselineTest, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  Stop cancelled;
  cancelled.cancellation = source.get_token();
  EXPECT_THAT(RegisterBaseline(SparseGround(0.3, 1), SparseGround(0.0, 2), With(GetParam()), cancelled),
              HasCode(absl::StatusCode::kCancelled));
  Stop late;
  late.deadline = std::chrono::steady_clock::now();
  const auto result = RegisterBaseline(SparseGround(0.3, 1), SparseGround(0.0, 2), With(GetParam()), late);
  ASSERT_THAT(result, IsOk());
  EXPECT_THAT(result->verdict.reasons, ElementsAre(Reason::kDeadline));
}

INSTANTIATE_TEST_SUITE_P(Baselines, RegisterBaselineTest, ::testing::ValuesIn(kBaselines),
                         [](const auto& method) { return method.param == Method::kFpfhSacIa ? "Fpfh" : "Harris"; });

}  // namespace
}  // namespace curvereg
