// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/register_paper.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>

#include "core/base/parallel.h"
#include "tests/testing/hummocks.h"

namespace curvereg {
namespace {

using testing::SmallMotion;
using testing::TwoScans;

bool SameBytes(const RegistrationResult& a, const RegistrationResult& b) {
  const RigidTransform T_a = a.T_target_source.value_or(RigidTransform::Identity());
  const RigidTransform T_b = b.T_target_source.value_or(RigidTransform::Identity());
  return std::memcmp(T_a.data(), T_b.data(), sizeof(double) * 16) == 0 &&
         a.T_target_source.has_value() == b.T_target_source.has_value() &&
         a.evidence.num_matches == b.evidence.num_matches && a.evidence.num_inliers == b.evidence.num_inliers &&
         a.evidence.num_source_keypoints == b.evidence.num_source_keypoints;
}

TEST(RegisterPaperTest, RecoversASmallMotion) {
  const TwoScans& scans = SmallMotion();
  const auto result = RegisterPaper(scans.source, scans.target, RegistrationOptions{}, Stop{});
  ASSERT_TRUE(result.ok()) << result.status();
  ASSERT_TRUE(result->T_target_source.has_value());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_TRUE(result->verdict.reasons.empty());
  const TransformDifference error = Difference(*result->T_target_source, scans.T_target_source);
  EXPECT_LT(error.translation_m, 0.15);
  EXPECT_LT(error.rotation_rad, 0.02);
  EXPECT_TRUE(IsRigid(*result->T_target_source, 1e-12));
  EXPECT_GT(result->evidence.num_source_points, 20000);
  EXPECT_GT(result->evidence.num_source_keypoints, 50);
  EXPECT_GT(result->evidence.num_target_keypoints, 50);
  EXPECT_GE(result->evidence.num_source_keypoints, result->evidence.num_matches);
  EXPECT_GE(result->evidence.num_matches, result->evidence.num_inliers);
  ASSERT_EQ(result->stage_times.size(), 3U);
  EXPECT_EQ(result->stage_times[0].stage, "features");
}

TEST(RegisterPaperTest, AScanLiesOnItself) {
  const Scan& scan = SmallMotion().target;
  const auto result = RegisterPaper(scan, scan, RegistrationOptions{}, Stop{});
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_LT(Difference(*result->T_target_source, RigidTransform::Identity()).translation_m, 1e-6);
  EXPECT_EQ(result->evidence.num_inliers, result->evidence.num_matches);
  EXPECT_EQ(result->evidence.num_matches, result->evidence.num_source_keypoints);
}

TEST(RegisterPaperTest, ScansWithoutFeaturesAreRejected) {
  const Scan& good = SmallMotion().target;
  Scan few;
  few.points = {{5.0F, 0.0F, 0.0F}, {0.0F, 6.0F, 0.0F}, {0.0F, 0.0F, 7.0F}};
  for (const Scan& bad : {Scan{}, few}) {
    for (const bool is_source : {true, false}) {
      const auto result = RegisterPaper(is_source ? bad : good, is_source ? good : bad, RegistrationOptions{}, Stop{});
      ASSERT_TRUE(result.ok()) << result.status();
      EXPECT_FALSE(result->verdict.accepted);
      ASSERT_EQ(result->verdict.reasons.size(), 1U);
    }
  }
  const auto result = RegisterPaper(Scan{}, good, RegistrationOptions{}, Stop{});
  EXPECT_EQ(result->verdict.reasons[0], Reason::kTooFewFeatures);
  EXPECT_FALSE(result->T_target_source.has_value());
}

TEST(RegisterPaperTest, AnotherPlaceHasNoConsensus) {
  const auto result = RegisterPaper(testing::ScanHummocks(testing::Mast(400.0, 300.0, 1.0)), SmallMotion().target,
                                    RegistrationOptions{}, Stop{});
  ASSERT_TRUE(result.ok());
  EXPECT_FALSE(result->verdict.accepted);
  EXPECT_EQ(result->verdict.reasons, std::vector<Reason>{Reason::kNoConsensus});
}

TEST(RegisterPaperTest, SameBytesAtAnyThreadCount) {
  const TwoScans& scans = SmallMotion();
  const RegistrationResult serial = *RegisterPaper(scans.source, scans.target, RegistrationOptions{}, Stop{});
  for (const int num_threads : {1, 2, 4}) {
    RegistrationResult result;
    WithThreadLimit(num_threads,
                    [&] { result = *RegisterPaper(scans.source, scans.target, RegistrationOptions{}, Stop{}); });
    EXPECT_TRUE(SameBytes(result, serial)) << num_threads;
  }
}

TEST(RegisterPaperTest, CancelledOrLate) {
  const TwoScans& scans = SmallMotion();
  std::stop_source source;
  source.request_stop();
  EXPECT_EQ(
      RegisterPaper(scans.source, scans.target, RegistrationOptions{}, Stop{source.get_token(), {}}).status().code(),
      absl::StatusCode::kCancelled);
  const auto late =
      RegisterPaper(scans.source, scans.target, RegistrationOptions{}, Stop{{}, std::chrono::steady_clock::now()});
  ASSERT_TRUE(late.ok());
  EXPECT_FALSE(late->verdict.accepted);
  EXPECT_EQ(late->verdict.reasons, std::vector<Reason>{Reason::kDeadline});
}

TEST(RegisterPaperTest, CancellingAmidTheWorkEndsIt) {
  const TwoScans& scans = SmallMotion();
  PaperOptions endless;
  endless.ransac.inlier_threshold_m = 1e-6;
  endless.ransac.max_iterations = std::numeric_limits<int>::max();
  std::stop_source source;
  std::jthread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    source.request_stop();
  });
  EXPECT_EQ(RegisterPaper(scans.source, scans.target, endless, Stop{source.get_token(), {}}).status().code(),
            absl::StatusCode::kCancelled);
}

TEST(RegisterPaperTest, RefusesBadOptions) {
  const TwoScans& scans = SmallMotion();
  std::vector<PaperOptions> bad(6);
  bad[0].max_false_alarms = 0.0;
  bad[1].features.min_range_m = -1.0;
  bad[2].matching.epsilon = std::nan("");
  bad[3].features.num_scales = 9;
  bad[4].features.image.step_rad = 0.0;
  bad[5].ransac.confidence = 2.0;
  for (size_t i = 0; i < bad.size(); ++i) {
    EXPECT_EQ(RegisterPaper(scans.source, scans.target, bad[i], Stop{}).status().code(),
              absl::StatusCode::kInvalidArgument)
        << i;
  }
}

}  // namespace
}  // namespace curvereg
