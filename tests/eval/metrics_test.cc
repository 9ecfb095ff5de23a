// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

// An answer that is off by `metres` along x and `radians` about z.
PairOutcome Answer(double metres, double radians, bool accepted) {
  PairOutcome outcome;
  outcome.true_T_target_source = TransformFromVector((Vector6d() << 0.1, -0.2, 0.3, 4.0, 5.0, 6.0).finished());
  outcome.result.T_target_source = Eigen::Translation3d(metres, 0.0, 0.0) * *outcome.true_T_target_source *
                                   Eigen::AngleAxisd(radians, Eigen::Vector3d::UnitZ());
  outcome.result.verdict.accepted = accepted;
  outcome.result.verdict.reasons.clear();
  outcome.seconds = 1.0;
  return outcome;
}

PairOutcome NoPose() {
  PairOutcome outcome;
  outcome.true_T_target_source = RigidTransform::Identity();
  outcome.seconds = 3.0;
  return outcome;
}

TEST(PoseError, MeasuresTranslationAndRotation) {
  const TransformDifference error = PoseError(Answer(0.25, 0.05, true));
  EXPECT_NEAR(error.translation_m, 0.25, 1e-12);
  EXPECT_NEAR(error.rotation_rad, 0.05, 1e-9);
}

TEST(PoseError, IsUnknownWithoutPoseOrTruth) {
  EXPECT_TRUE(std::isnan(PoseError(NoPose()).translation_m));
  PairOutcome negative = Answer(0.0, 0.0, true);
  negative.true_T_target_source.reset();
  EXPECT_TRUE(std::isnan(PoseError(negative).rotation_rad));
  EXPECT_FALSE(IsOk(negative));
}

TEST(IsOk, BothBoundsAreExclusiveAndBothCount) {
  EXPECT_TRUE(IsOk(Answer(0.49, 0.099, false)));
  EXPECT_FALSE(IsOk(Answer(0.51, 0.0, true)));
  EXPECT_FALSE(IsOk(Answer(0.0, 0.101, true)));
  EXPECT_FALSE(IsOk(NoPose()));
  // Bounds of zero are met by nothing, not even by a perfect pose.
  EXPECT_FALSE(IsOk(Answer(0.0, 0.0, true), {.translation_m = 0.0, .rotation_rad = 0.1}));
}

TEST(Summarise, CountsEveryFailure) {
  const std::vector<PairOutcome> outcomes = {Answer(0.3, 0.0, true), Answer(0.4, 0.0, false), Answer(2.0, 0.0, true),
                                             Answer(9.0, 0.0, false), NoPose()};
  const MethodSummary summary = Summarise(outcomes);
  EXPECT_EQ(summary.pairs, 5);
  EXPECT_EQ(summary.ok, 2);
  EXPECT_EQ(summary.accepted, 2);
  EXPECT_EQ(summary.accepted_wrong, 1);
  EXPECT_EQ(summary.rejected_right, 1);
  EXPECT_EQ(summary.no_pose, 1);
  EXPECT_NEAR(summary.rmse_translation_m, std::sqrt((0.09 + 0.16 + 4.0 + 81.0) / 4.0), 1e-9);
  EXPECT_NEAR(summary.rmse_ok_translation_m, std::sqrt((0.09 + 0.16) / 2.0), 1e-9);
  EXPECT_NEAR(summary.median_translation_m, 1.2, 1e-9);
  EXPECT_NEAR(summary.median_ok_translation_m, 0.35, 1e-9);
  EXPECT_NEAR(summary.rmse_rotation_rad, 0.0, 1e-7);
  EXPECT_DOUBLE_EQ(summary.median_s, 1.0);
  EXPECT_DOUBLE_EQ(summary.p95_s, 2.6);
}

TEST(Summarise, AcceptedNegativePairsAreWrong) {
  PairOutcome accepted = Answer(0.0, 0.0, true);
  accepted.true_T_target_source.reset();
  PairOutcome rejected = NoPose();
  rejected.true_T_target_source.reset();
  const MethodSummary summary = Summarise(std::vector<PairOutcome>{accepted, rejected, Answer(0.1, 0.0, true)});
  EXPECT_EQ(summary.pairs, 1);
  EXPECT_EQ(summary.negatives, 2);
  EXPECT_EQ(summary.negatives_accepted, 1);
  EXPECT_EQ(summary.accepted, 2);
  EXPECT_EQ(summary.accepted_wrong, 1);
  EXPECT_EQ(summary.no_pose, 0);
}

TEST(Summarise, FailedCallsAreFailuresWithoutAPose) {
  PairOutcome failed = NoPose();
  failed.error = "too few points";
  const MethodSummary summary = Summarise(std::vector<PairOutcome>{failed});
  EXPECT_EQ(summary.pairs, 1);
  EXPECT_EQ(summary.failed_calls, 1);
  EXPECT_EQ(summary.no_pose, 1);
  EXPECT_EQ(summary.accepted, 0);
}

TEST(Summarise, NothingGivesZeroCountsAndNoFigures) {
  const MethodSummary summary = Summarise({});
  EXPECT_EQ(summary.pairs, 0);
  EXPECT_TRUE(std::isnan(summary.rmse_translation_m));
  EXPECT_TRUE(std::isnan(summary.median_s));
}

}  // namespace
}  // namespace curvereg
