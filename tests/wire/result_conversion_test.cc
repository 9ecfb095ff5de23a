// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/result_conversion.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "core/methods/registration_names.h"
#include "tests/testing/matchers.h"
#include "tests/testing/result_bytes.h"
#include "tests/wire/conversion_samples.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::BytesOf;
using ::curvereg::testing::IsNear;
using ::curvereg::testing::IsOk;

// Every field another value, and none at its default.
RegistrationResult FullResult() {
  RegistrationResult result;
  result.T_target_source = SomePose();
  result.covariance = SomeCovariance();
  result.verdict.reasons = {Reason::kAmbiguous, Reason::kDeadline};
  for (int i = 0; i < 2; ++i) {
    DegenerateDirection direction;
    direction.direction = Vector6d::LinSpaced(1.0, 2.0 + i).normalized();
    direction.sigma = i == 0 ? 0.25 : kInfinity;
    result.degenerate_directions.push_back(direction);
  }
  result.evidence = {224000, 223999, 310, 311, 120, 45, 6, 2, 0.7, 0.6, 0.97, -0.25, 0.9, 0.03, 0.02, 0.05, 1.5};
  result.stage_times = {{"preparation", 0.125}, {"matching", 0.000001}};
  result.total_seconds = 0.5;
  result.seed = 17;
  result.options_digest = "options";
  result.source_digest = "source";
  result.target_digest = "target";
  result.build_id = "build";
  return result;
}

TEST(ResultConversionTest, ResultsComeBackInEveryField) {
  RegistrationResult result = FullResult();
  const auto back = FromWire(ToWire(result));
  ASSERT_THAT(back, IsOk());
  EXPECT_THAT(back->T_target_source, IsNear(result.T_target_source, 0.0, 1e-14));
  result.T_target_source = back->T_target_source;  // equal but for the rounding of a quaternion; the rest to the bit
  EXPECT_EQ(BytesOf(*back), BytesOf(result));
  ASSERT_EQ(back->stage_times.size(), result.stage_times.size());
  for (size_t i = 0; i < result.stage_times.size(); ++i) {
    EXPECT_NEAR(back->stage_times[i].seconds, result.stage_times[i].seconds, 1e-9);
  }
  EXPECT_EQ(back->total_seconds, result.total_seconds);
}

// A result that was never filled in has no pose, no covariance and no measure: none of them may come back as zero.
TEST(ResultConversionTest, WhatIsAbsentStaysAbsent) {
  const RegistrationResult born;
  const v1::RegistrationResult message = ToWire(born);
  EXPECT_FALSE(message.has_t_target_source());
  EXPECT_FALSE(message.has_covariance());
  EXPECT_FALSE(message.evidence().has_source_overlap());
  EXPECT_FALSE(message.evidence().has_image_correlation());
  const auto back = FromWire(message);
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(BytesOf(*back), BytesOf(born));
}

TEST(ResultConversionTest, MeasuresOfZeroArePresent) {
  RegistrationResult result;
  result.evidence.overlap_source = 0.0;
  result.evidence.image_correlation = -0.5;
  result.evidence.residual_rmse_m = kNan;
  const auto back = FromWire(ToWire(result));
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(back->evidence.overlap_source, 0.0);
  EXPECT_EQ(back->evidence.image_correlation, -0.5);
  EXPECT_EQ(back->evidence.residual_rmse_m, std::nullopt);
}

TEST(ResultConversionTest, EveryReasonComesBack) {
  for (int i = 0; i <= static_cast<int>(Reason::kDeadline); ++i) {
    RegistrationResult result;
    result.verdict.reasons = {static_cast<Reason>(i)};
    const v1::RegistrationResult message = ToWire(result);
    std::string name = "VERDICT_REASON_" + std::string(ReasonName(static_cast<Reason>(i)));
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
    EXPECT_EQ(v1::VerdictReason_Name(message.verdict().reasons(0)), name);
    const auto back = FromWire(message);
    ASSERT_THAT(back, IsOk());
    EXPECT_EQ(back->verdict.reasons, result.verdict.reasons);
  }
  EXPECT_EQ(v1::VerdictReason_ARRAYSIZE, static_cast<int>(Reason::kDeadline) + 2);
}

TEST(ResultConversionTest, ResultsThatContradictThemselvesNameTheField) {
  const auto field_after = [](const std::function<void(v1::RegistrationResult&)>& change) {
    v1::RegistrationResult message = ToWire(FullResult());
    change(message);
    return FieldOf(FromWire(message).status());
  };
  EXPECT_EQ(field_after([](auto& m) { m.clear_verdict(); }), "verdict");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_verdict()->set_accepted(true); }), "verdict.reasons");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_verdict()->clear_reasons(); }), "verdict.reasons");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_verdict()->set_reasons(1, v1::VERDICT_REASON_UNSPECIFIED); }),
            "verdict.reasons[1]");
  EXPECT_EQ(field_after([](auto& m) {
              m.mutable_verdict()->set_accepted(true);
              m.mutable_verdict()->clear_reasons();
              m.clear_t_target_source();
            }),
            "t_target_source");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_t_target_source()->clear_rotation(); }), "t_target_source.rotation");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_covariance()->set_upper_triangle(0, kNan); }),
            "covariance.upper_triangle");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_degenerate_directions(1)->add_direction(0.0); }),
            "degenerate_directions[1].direction");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_degenerate_directions(0)->set_direction(2, kNan); }),
            "degenerate_directions[0].direction");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_degenerate_directions(0)->set_sigma(-1.0); }),
            "degenerate_directions[0].sigma");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_evidence()->set_source_point_count(UINT64_MAX); }),
            "evidence.source_point_count");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_evidence()->set_match_count(UINT32_MAX); }), "evidence.match_count");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_evidence()->set_target_overlap(1.5); }), "evidence.target_overlap");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_evidence()->set_residual_p90_m(kNan); }), "evidence.residual_p90_m");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_evidence()->set_runner_up_ratio(-2.0); }), "evidence.runner_up_ratio");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_stage_times(1)->mutable_duration()->set_nanos(-1); }),
            "stage_times[1].duration");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_total_time()->set_seconds(-1); }), "total_time");
}

TEST(ResultConversionTest, SummaryHoldsWhatTheResultHolds) {
  const RegistrationResult result = FullResult();
  const v1::RegistrationSummary summary = ToSummary(result);
  EXPECT_FALSE(summary.accepted());
  ASSERT_EQ(summary.reasons_size(), 2);
  EXPECT_EQ(summary.reasons(0), v1::VERDICT_REASON_AMBIGUOUS);
  EXPECT_EQ(summary.reasons(1), v1::VERDICT_REASON_DEADLINE);
  ASSERT_EQ(summary.translation_size(), 3);
  EXPECT_EQ(summary.translation(1), -3.25);
  ASSERT_EQ(summary.rotation_size(), 4);
  const Eigen::Quaterniond rotation(summary.rotation(3), summary.rotation(0), summary.rotation(1), summary.rotation(2));
  EXPECT_LT(rotation.angularDistance(Eigen::Quaterniond(result.T_target_source->linear())), 1e-6);
  ASSERT_EQ(summary.sigma_size(), 6);
  EXPECT_FLOAT_EQ(summary.sigma(5), static_cast<float>(std::sqrt((*result.covariance)(5, 5))));
  EXPECT_FLOAT_EQ(summary.overlap(), 0.6F);
  EXPECT_FLOAT_EQ(summary.residual_rmse_m(), 0.03F);
  EXPECT_FLOAT_EQ(summary.runner_up_ratio(), 1.5F);
  EXPECT_EQ(summary.inlier_count(), 45U);
  EXPECT_EQ(summary.degenerate_direction_count(), 2U);
  EXPECT_EQ(summary.total_ms(), 500U);
}

TEST(ResultConversionTest, SummaryOfNothingHasNoPose) {
  const v1::RegistrationSummary summary = ToSummary(RegistrationResult());
  EXPECT_FALSE(summary.accepted());
  EXPECT_EQ(summary.reasons_size(), 1);
  EXPECT_EQ(summary.translation_size() + summary.rotation_size() + summary.sigma_size(), 0);
  EXPECT_FALSE(summary.has_overlap());
  EXPECT_FALSE(summary.has_residual_rmse_m());
  EXPECT_FALSE(summary.has_runner_up_ratio());
}

TEST(ResultConversionTest, TheLargestSummaryHas200BytesAtMost) {
  RegistrationResult worst = FullResult();
  worst.verdict.accepted = true;  // contradicts the reasons; only the size matters here
  worst.verdict.reasons.clear();
  for (int repeat = 0; repeat < 100; ++repeat) {
    for (int i = 0; i <= static_cast<int>(Reason::kDeadline); ++i) {
      worst.verdict.reasons.push_back(static_cast<Reason>(i));
    }
  }
  worst.degenerate_directions.assign(1'000'000, DegenerateDirection());
  worst.evidence.num_inliers = std::numeric_limits<int>::max();
  worst.evidence.runner_up_ratio = kInfinity;
  worst.total_seconds = 1e12;
  const v1::RegistrationSummary summary = ToSummary(worst);
  EXPECT_EQ(summary.reasons_size(), 10);
  EXPECT_EQ(summary.total_ms(), UINT32_MAX);
  EXPECT_LE(summary.ByteSizeLong(), 200U);
  EXPECT_GT(summary.ByteSizeLong(), 100U);  // it is the worst case, not an empty one
  RecordProperty("bytes", static_cast<int>(summary.ByteSizeLong()));
}

}  // namespace
}  // namespace curvereg::wire
