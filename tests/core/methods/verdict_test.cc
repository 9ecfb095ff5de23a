// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Precondition: the scan is valid.
std::unique_ptr<const PreparedScan> Prepared(Scan scan) {
  return *PreparedScan::Create(std::make_shared<Scan>(std::move(scan)));
}

struct Pair {
  std::unique_ptr<const PreparedScan> prepared_source;
  std::unique_ptr<const PreparedScan> prepared_target;
  RigidTransform T_target_source;
  const PreparedScan& source = *prepared_source;
  const PreparedScan& target = *prepared_target;
};

const Pair& GroundPair() {
  static const RigidTransform T_world_source = testing::RoverPose(3.0, 1.0, 0.4);
  static const RigidTransform T_world_target = testing::RoverPose(0.0, 0.0, 0.0);
  static const Pair pair{Prepared(testing::BumpyGround(T_world_source, {.noise_seed = 1})),
                         Prepared(testing::BumpyGround(T_world_target, {.noise_seed = 2})),
                         T_world_target.inverse() * T_world_source};
  return pair;
}

SurfaceFit FitOf(const PreparedScan& source, const PreparedScan& target, const RigidTransform& T_target_source) {
  return RefineOnLevels(source.voxel_maps(), target.voxel_maps(), {0, 2}, T_target_source, {}, {});
}

PoseEvidence GoodEvidence() {
  PoseEvidence evidence;
  evidence.check = {.free_space_agreement = 0.99, .overlap_source = 0.7, .overlap_target = 0.8};
  evidence.fit.num_pairs = 1000;
  evidence.fit.inlier_fraction = 0.95;
  evidence.fit.residual_rms_m = 0.02;
  evidence.image_correlation = 0.8;
  evidence.num_matches = 200;
  evidence.num_inliers = 60;
  evidence.runner_up_ratio = 0.1;
  return evidence;
}

TEST(CheckPoseTest, TheTruePoseAgreesAndAWrongOneDoesNot) {
  const Pair& pair = GroundPair();
  const PoseCheck right = CheckPose(pair.source, pair.target, pair.T_target_source);
  EXPECT_GT(right.free_space_agreement, 0.95);
  EXPECT_GT(right.overlap_source, 0.5);
  EXPECT_LE(right.overlap_source, 1.0);
  EXPECT_GT(right.overlap_target, 0.5);
  EXPECT_LE(right.overlap_target, 1.0);
  const PoseCheck buried =
      CheckPose(pair.source, pair.target, testing::UprightPose(0.0, 0.0, 0.0, 1.0) * pair.T_target_source);
  EXPECT_LT(buried.free_space_agreement, 0.7);
  const PoseCheck apart =
      CheckPose(pair.source, pair.target, testing::UprightPose(200.0, 0.0, 0.0, 0.0) * pair.T_target_source);
  EXPECT_LT(apart.overlap_source, 0.05);
}

TEST(CheckPoseTest, BothWaysAreTheSameCheck) {
  const Pair& pair = GroundPair();
  const PoseCheck forward = CheckPose(pair.source, pair.target, pair.T_target_source);
  const PoseCheck backward = CheckPose(pair.target, pair.source, pair.T_target_source.inverse());
  EXPECT_NEAR(forward.free_space_agreement, backward.free_space_agreement, 1e-3);
  EXPECT_NEAR(forward.overlap_source, backward.overlap_target, 1e-3);
  EXPECT_NEAR(forward.overlap_target, backward.overlap_source, 1e-3);
}

TEST(CorrelateViewsTest, OneForItselfHighForTheTruthLowElsewhere) {
  const Pair& pair = GroundPair();
  const ViewFeatures& source = **pair.source.View(BirdsEyeView::kElevation, 0);
  const ViewFeatures& target = **pair.target.View(BirdsEyeView::kElevation, 0);
  const ViewCorrelation itself = CorrelateViews(source, source, RigidTransform::Identity());
  EXPECT_NEAR(itself.ncc, 1.0, 1e-9);
  EXPECT_GT(itself.num_pixels, 300);
  EXPECT_GT(CorrelateViews(source, target, pair.T_target_source).ncc, 0.6);
  EXPECT_LT(CorrelateViews(source, target, testing::UprightPose(2.0, 3.0, 0.0, 0.0) * pair.T_target_source).ncc, 0.3);
}

TEST(CorrelateViewsTest, NothingInCommonIsNoCorrelation) {
  const ViewFeatures empty = *ComputeViewFeatures({}, Eigen::Matrix3d::Identity(), ElevationViewOptions());
  const ViewFeatures& ground = **GroundPair().source.View(BirdsEyeView::kElevation, 0);
  for (const ViewCorrelation& correlation :
       {CorrelateViews(empty, empty, RigidTransform::Identity()),
        CorrelateViews(empty, ground, RigidTransform::Identity()),
        CorrelateViews(ground, ground, testing::UprightPose(500.0, 0.0, 0.0, 0.0))}) {
    EXPECT_EQ(correlation.num_pixels, 0);
    EXPECT_EQ(correlation.ncc, 0.0);
  }
}

TEST(PoseScoreTest, FallsWithEachWeakness) {
  const double good = PoseScore(GoodEvidence());
  EXPECT_GT(good, 0.0);
  PoseEvidence evidence = GoodEvidence();
  evidence.check.free_space_agreement = 0.8;
  EXPECT_LT(PoseScore(evidence), good);
  evidence = GoodEvidence();
  evidence.check.overlap_target = 0.2;
  EXPECT_LT(PoseScore(evidence), good);
  evidence = GoodEvidence();
  evidence.fit.inlier_fraction = 0.5;
  EXPECT_LT(PoseScore(evidence), good);
  evidence = GoodEvidence();
  evidence.fit.residual_rms_m = 0.1;
  EXPECT_LT(PoseScore(evidence), good);
  evidence = GoodEvidence();
  evidence.image_correlation = 0.1;
  EXPECT_LT(PoseScore(evidence), good);
  evidence = GoodEvidence();
  evidence.num_inliers = 5;
  EXPECT_LT(PoseScore(evidence), good);
}

TEST(PoseConfidenceTest, FallsWithEachWeaknessAndStaysInItsRange) {
  const double good = PoseConfidence(GoodEvidence());
  EXPECT_GT(good, 0.1);
  EXPECT_LE(good, 1.1);
  EXPECT_EQ(PoseConfidence(PoseEvidence{}), 0.0);
  PoseEvidence evidence = GoodEvidence();
  evidence.check.free_space_agreement = 0.8;
  EXPECT_LT(PoseConfidence(evidence), good);
  evidence = GoodEvidence();
  evidence.fit.inlier_fraction = 0.5;
  EXPECT_LT(PoseConfidence(evidence), good);
  evidence = GoodEvidence();
  evidence.image_correlation = -0.5;
  EXPECT_LT(PoseConfidence(evidence), good);
  EXPECT_GE(PoseConfidence(evidence), 0.0);
}

TEST(FindDegenerateDirectionsTest, UnevenGroundHasNone) {
  const Pair& pair = GroundPair();
  const SurfaceFit fit = FitOf(pair.source, pair.target, pair.T_target_source);
  EXPECT_THAT(FindDegenerateDirections(fit, VerdictOptions{}.min_information_z), IsEmpty());
}

TEST(FindDegenerateDirectionsTest, AFlatPlainLeavesPlaceAndYawOpen) {
  const RigidTransform T_world_source = testing::UprightPose(2.0, 1.0, 0.4);
  const auto source = Prepared(testing::FlatGround(T_world_source, {.noise_seed = 1}));
  const auto target = Prepared(testing::FlatGround(testing::UprightPose(0.0, 0.0, 0.0), {.noise_seed = 2}));
  const RigidTransform T_target_source = testing::UprightPose(0.0, 0.0, 0.0).inverse() * T_world_source;
  const auto directions =
      FindDegenerateDirections(FitOf(*source, *target, T_target_source), VerdictOptions{}.min_information_z);
  ASSERT_EQ(directions.size(), 3U);
  for (const DegenerateDirection& degenerate : directions) {
    EXPECT_NEAR(degenerate.direction.norm(), 1.0, 1e-9);
    // Combinations of yaw, x and y; no roll or pitch, and height only as far as the plane is not quite level.
    EXPECT_LT(degenerate.direction.head<2>().norm(), 0.05);
    EXPECT_LT(std::abs(degenerate.direction[5]), 0.05);
    EXPECT_GT(degenerate.sigma, 0.0);
  }
}

TEST(FindDegenerateDirectionsTest, ATroughLeavesItsOwnDirectionOpen) {
  // A floor and two walls along x, as planes: nothing tells where along x the sensor is.
  const auto trough = [](uint64_t seed) {
    Scan scan;
    for (const testing::PlanePatch& patch : {testing::PlanePatch{{0.0, 0.0, -1.6}, {0.0, 0.0, 1.0}, 12.0, 0.005},
                                             testing::PlanePatch{{0.0, 3.05, 1.2}, {0.0, -1.0, 0.0}, 12.0, 0.005},
                                             testing::PlanePatch{{0.0, -2.95, 1.2}, {0.0, 1.0, 0.0}, 12.0, 0.005}}) {
      const auto points = testing::PatchPoints(patch, 20000, seed++);
      scan.points.insert(scan.points.end(), points.begin(), points.end());
    }
    return scan;
  };
  const auto source = Prepared(trough(10));
  const auto target = Prepared(trough(20));
  const auto directions =
      FindDegenerateDirections(FitOf(*source, *target, RigidTransform::Identity()), VerdictOptions{}.min_information_z);
  ASSERT_EQ(directions.size(), 1U);
  EXPECT_GT(std::abs(directions[0].direction[3]), 0.99);
}

TEST(FillResultTest, WritesPoseVerdictAndMeasures) {
  const Pair& pair = GroundPair();
  PoseEvidence evidence = GoodEvidence();
  evidence.fit = FitOf(pair.source, pair.target, pair.T_target_source);
  RegistrationResult result;
  FillResult(pair.T_target_source, evidence, result);
  EXPECT_TRUE(result.T_target_source.has_value());
  EXPECT_EQ(result.T_target_source->matrix(), pair.T_target_source.matrix());
  EXPECT_TRUE(result.verdict.accepted);
  EXPECT_THAT(result.verdict.reasons, IsEmpty());
  EXPECT_THAT(result.degenerate_directions, IsEmpty());
  EXPECT_TRUE(result.covariance.has_value());
  EXPECT_EQ(result.covariance, PoseCovariance(evidence.fit));
  EXPECT_EQ(result.evidence.num_inliers, 60);
  EXPECT_EQ(result.evidence.overlap_source, 0.7);
  EXPECT_EQ(result.evidence.image_correlation, 0.8);
  EXPECT_EQ(result.evidence.residual_rmse_m, evidence.fit.residual_rms_m);
}

TEST(DecideVerdictTest, GoodEvidenceIsAccepted) {
  const Verdict verdict = DecideVerdict(GoodEvidence(), {});
  EXPECT_TRUE(verdict.accepted);
  EXPECT_THAT(verdict.reasons, IsEmpty());
}

TEST(DecideVerdictTest, EachWeaknessHasItsReason) {
  const auto reasons = [](auto weaken) {
    PoseEvidence evidence = GoodEvidence();
    weaken(evidence);
    const Verdict verdict = DecideVerdict(evidence, {});
    EXPECT_FALSE(verdict.accepted);
    return verdict.reasons;
  };
  EXPECT_THAT(reasons([](PoseEvidence& e) { e.fit.num_pairs = 5; }), ElementsAre(Reason::kTooFewPoints));
  EXPECT_THAT(reasons([](PoseEvidence& e) { e.fit.inlier_fraction = 0.3; }), ElementsAre(Reason::kResidualTooHigh));
  EXPECT_THAT(reasons([](PoseEvidence& e) { e.check.overlap_source = 0.05; }), ElementsAre(Reason::kOverlapTooLow));
  EXPECT_THAT(reasons([](PoseEvidence& e) { e.check.overlap_target = 0.05; }), ElementsAre(Reason::kOverlapTooLow));
  EXPECT_THAT(reasons([](PoseEvidence& e) { e.check.free_space_agreement = 0.6; }),
              ElementsAre(Reason::kFreeSpaceViolated));
  EXPECT_THAT(reasons([](PoseEvidence& e) { e.image_correlation = 0.0; }), ElementsAre(Reason::kNoConsensus));
  EXPECT_THAT(reasons([](PoseEvidence& e) { e.runner_up_ratio = 0.99; }), ElementsAre(Reason::kAmbiguous));
}

TEST(DecideVerdictTest, DegenerateDirectionsReject) {
  const Verdict verdict = DecideVerdict(GoodEvidence(), {DegenerateDirection{}});
  EXPECT_FALSE(verdict.accepted);
  EXPECT_THAT(verdict.reasons, ElementsAre(Reason::kDegenerateDirection));
}

TEST(DecideVerdictTest, NoEvidenceIsRejected) {
  const Verdict verdict = DecideVerdict(PoseEvidence{}, {});
  EXPECT_FALSE(verdict.accepted);
  EXPECT_FALSE(verdict.reasons.empty());
}

TEST(DecideVerdictTest, WhatIsNotANumberIsNoEvidence) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (double PoseCheck::*member :
       {&PoseCheck::free_space_agreement, &PoseCheck::overlap_source, &PoseCheck::overlap_target}) {
    PoseEvidence evidence = GoodEvidence();
    evidence.check.*member = kNan;
    EXPECT_FALSE(DecideVerdict(evidence, {}).accepted);
  }
  for (double PoseEvidence::*member : {&PoseEvidence::image_correlation, &PoseEvidence::runner_up_ratio}) {
    PoseEvidence evidence = GoodEvidence();
    evidence.*member = kNan;
    EXPECT_FALSE(DecideVerdict(evidence, {}).accepted);
  }
  PoseEvidence evidence = GoodEvidence();
  evidence.fit.inlier_fraction = kNan;
  EXPECT_FALSE(DecideVerdict(evidence, {}).accepted);
}

}  // namespace
}  // namespace curvereg
