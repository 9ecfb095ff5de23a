// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a caller knows beforehand (priors, gravity), and what a caller must not say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/register_scans.h"
#include "tests/testing/matchers.h"
#include "tests/testing/result_bytes.h"
#include "tests/testing/scenes.h"
#include "tests/testing/simulated.h"

namespace curvereg {
namespace {

using ::testing::Contains;
using testing::HasCode;
using ::testing::HasSubstr;
using testing::IsNear;
using testing::IsOk;
using ::testing::Not;
using testing::ScanPairWithTruth;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

const ScanPairWithTruth& YardPair() {
  static const ScanPairWithTruth pair = testing::PairOf("random-yaw", 3, 2);
  return pair;
}

RigidTransform Moved(const RigidTransform& T, const Vector6d& delta) { return TransformFromVector(delta) * T; }

Prior PriorOff(const Vector6d& delta) {
  Prior prior;
  prior.T_target_source = Moved(YardPair().T_target_source, delta);
  return prior;
}

// A covariance with standard deviations of 0.05 rad and 0.2 m.
Matrix6d SmallCovariance() {
  Vector6d sigmas;
  sigmas << 0.05, 0.05, 0.05, 0.2, 0.2, 0.2;
  return sigmas.array().square().matrix().asDiagonal();
}

absl::StatusOr<RegistrationResult> With(const std::optional<Prior>& prior, Method method = Method::kCurvelet) {
  RegistrationOptions options;
  options.method = method;
  options.prior = prior;
  return RegisterScans(YardPair().source, YardPair().target, options);
}

Vector6d Delta(double yaw_rad, double x_m) {
  Vector6d delta = Vector6d::Zero();
  delta[2] = yaw_rad;
  delta[3] = x_m;
  return delta;
}

TEST(PriorTest, WithoutCovarianceItIsOneMoreHypothesis) {
  const auto without = With(std::nullopt);
  ASSERT_THAT(without, IsOk());
  for (const Prior& prior : {PriorOff(Delta(0.0, 0.1)), PriorOff(Delta(2.0, 30.0))}) {
    const auto with = With(prior);
    ASSERT_THAT(with, IsOk());
    EXPECT_TRUE(with->verdict.accepted);
    EXPECT_EQ(with->evidence.num_hypotheses, without->evidence.num_hypotheses + 1);
    EXPECT_THAT(with->T_target_source, IsNear(YardPair().T_target_source, 0.01, 0.001));
  }
}

TEST(PriorTest, WithinFiveSigmaThePoseIsFound) {
  for (const Vector6d& delta : {Delta(0.0, 0.0), Delta(0.1, 0.0), Delta(0.0, 0.8), Delta(-0.15, -0.4)}) {
    Prior prior = PriorOff(delta);
    prior.covariance = SmallCovariance();
    const auto result = With(prior);
    ASSERT_THAT(result, IsOk());
    EXPECT_TRUE(result->verdict.accepted);
    EXPECT_THAT(result->T_target_source, IsNear(YardPair().T_target_source, 0.01, 0.001));
  }
}

TEST(PriorTest, BeyondFiveSigmaItIsExcluded) {
  for (const Vector6d& delta : {Delta(0.3, 0.0), Delta(0.0, 1.3), Delta(1.5, 0.0), Delta(0.0, -20.0)}) {
    Prior prior = PriorOff(delta);
    prior.covariance = SmallCovariance();
    const auto result = With(prior);
    ASSERT_THAT(result, IsOk());
    EXPECT_FALSE(result->verdict.accepted);
    EXPECT_FALSE(result->verdict.reasons.empty());
    if (result->T_target_source.has_value()) {
      const RigidTransform off = *result->T_target_source * prior.T_target_source.inverse();
      Vector6d error;
      error << VectorFromRotation(off.linear()),
          result->T_target_source->translation() - prior.T_target_source.translation();
      // A refinement may carry it to the edge, not over to the true pose.
      EXPECT_LT(std::sqrt(error.dot(prior.covariance->ldlt().solve(error))), 6.0);
    }
  }
}

TEST(PriorTest, IcpStartsFromIt) {
  const auto from_prior = With(PriorOff(Delta(0.05, 0.5)), Method::kIcp);
  ASSERT_THAT(from_prior, IsOk());
  EXPECT_TRUE(from_prior->verdict.accepted);
  EXPECT_THAT(from_prior->T_target_source, IsNear(YardPair().T_target_source, 0.01, 0.001));
  const auto from_identity = With(std::nullopt, Method::kIcp);
  ASSERT_THAT(from_identity, IsOk());
  EXPECT_FALSE(from_identity->verdict.accepted);
}

TEST(PriorTest, ItIsPartOfTheOptionsDigest) {
  Prior with_covariance = PriorOff(Delta(0.0, 0.1));
  with_covariance.covariance = SmallCovariance();
  EXPECT_NE(With(std::nullopt)->options_digest, With(PriorOff(Delta(0.0, 0.1)))->options_digest);
  EXPECT_NE(With(with_covariance)->options_digest, With(PriorOff(Delta(0.0, 0.1)))->options_digest);
}

// Down in the sensor frame for the poses of `world`, whose z is up.
Scan WithGravity(Scan scan, const Eigen::Vector3d& down) {
  scan.gravity = down;
  return scan;
}

TEST(GravityTest, ATrueOneServes) {
  sim::SimulationOptions options = *sim::PresetOptions("random-yaw");
  options.num_scans = 4;
  const sim::Simulation simulation = *sim::Simulation::Create(options);
  const auto down = [&](int i) {
    return Eigen::Vector3d(-9.81 * (simulation.T_world_scan(i).linear().transpose() * Eigen::Vector3d::UnitZ()));
  };
  const auto result =
      RegisterScans(WithGravity(simulation.ScanAt(3), down(3)), WithGravity(simulation.ScanAt(2), down(2)));
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->T_target_source, IsNear(YardPair().T_target_source, 0.01, 0.001));
}

TEST(GravityTest, AWrongOneIsBelieved) {
  // Views along the horizon of the one scan and from above of the other have nothing in common; without gravity the
  // vertical is found, so only a method that uses what it was given fails here.
  const auto result = RegisterScans(WithGravity(YardPair().source, Eigen::Vector3d::UnitX()),
                                    WithGravity(YardPair().target, -Eigen::Vector3d::UnitZ()));
  ASSERT_THAT(result, IsOk());
  EXPECT_FALSE(result->verdict.accepted);
}

TEST(GravityTest, OnlyItsDirectionCounts) {
  const auto at_earth = RegisterScans(WithGravity(YardPair().source, {0.0, 0.0, -9.81}), YardPair().target);
  const auto at_mars = RegisterScans(WithGravity(YardPair().source, {0.0, 0.0, -3.72}), YardPair().target);
  ASSERT_THAT(at_earth, IsOk());
  ASSERT_THAT(at_mars, IsOk());
  EXPECT_TRUE(at_earth->verdict.accepted);
  EXPECT_THAT(at_mars->T_target_source, IsNear(at_earth->T_target_source, 1e-4, 1e-5));
  EXPECT_NE(at_mars->source_digest, at_earth->source_digest);
}

void ExpectRefused(const absl::StatusOr<RegistrationResult>& result, const std::string& words) {
  EXPECT_THAT(result, HasCode(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(std::string(result.status().message()), HasSubstr(words));
}

TEST(BadOptionsTest, Priors) {
  Prior scaled = PriorOff(Vector6d::Zero());
  scaled.T_target_source.linear() *= 1.01;
  Prior mirrored = PriorOff(Vector6d::Zero());
  mirrored.T_target_source.linear().col(0) *= -1.0;
  Prior unknown = PriorOff(Vector6d::Zero());
  unknown.T_target_source.translation().x() = kNan;
  Prior infinite = PriorOff(Vector6d::Zero());
  infinite.T_target_source.translation().y() = std::numeric_limits<double>::infinity();
  for (const Prior& prior : {scaled, mirrored, unknown, infinite}) ExpectRefused(With(prior), "prior");
}

TEST(BadOptionsTest, Covariances) {
  const auto with_covariance = [](const Matrix6d& covariance) {
    Prior prior = PriorOff(Vector6d::Zero());
    prior.covariance = covariance;
    return With(prior);
  };
  Matrix6d indefinite = SmallCovariance();
  indefinite(2, 2) = -1.0;
  Matrix6d unknown = SmallCovariance();
  unknown(4, 4) = kNan;
  Matrix6d lopsided = SmallCovariance();
  lopsided(0, 5) = 0.5;  // not symmetric
  Matrix6d infinite = SmallCovariance();
  infinite(3, 3) = std::numeric_limits<double>::infinity();
  for (const Matrix6d& bad : {Matrix6d(Matrix6d::Zero()), indefinite, unknown, lopsided, infinite}) {
    SCOPED_TRACE(::testing::Message() << bad);
    ExpectRefused(with_covariance(bad), "covariance");
  }
}

TEST(BadOptionsTest, Gravity) {
  for (const Eigen::Vector3d& bad : {Eigen::Vector3d(Eigen::Vector3d::Zero()), Eigen::Vector3d(0.0, 0.0, kNan),
                                     Eigen::Vector3d(std::numeric_limits<double>::infinity(), 0.0, 0.0)}) {
    for (const Method method : {Method::kCurvelet, Method::kIcp, Method::kPaper}) {
      RegistrationOptions options;
      options.method = method;
      ExpectRefused(RegisterScans(WithGravity(YardPair().source, bad), YardPair().target, options), "gravity");
      ExpectRefused(RegisterScans(YardPair().source, WithGravity(YardPair().target, bad), options), "gravity");
    }
  }
}

TEST(BadOptionsTest, Numbers) {
  const auto with = [](const auto& spoil) {
    RegistrationOptions options;
    spoil(options);
    return RegisterScans(YardPair().source, YardPair().target, options);
  };
  ExpectRefused(with([](RegistrationOptions& o) { o.num_threads = -1; }), "num_threads");
  for (const double budget : {0.0, -1.0, kNan}) {
    ExpectRefused(with([&](RegistrationOptions& o) { o.time_budget_s = budget; }), "time_budget_s");
  }
  ExpectRefused(with([](RegistrationOptions& o) { o.method = static_cast<Method>(99); }), "method");
  ExpectRefused(with([](RegistrationOptions& o) { o.limits.max_points = 1000; }), "at most 1000");
  ExpectRefused(with([](RegistrationOptions& o) { o.limits.min_points = 1'000'000; }), "at least 1000000");
  ExpectRefused(with([](RegistrationOptions& o) { o.limits.max_coordinate_m = 1.0; }), "1 m");
}

TEST(MethodTest, EveryNameRuns) {
  const auto ground = [](double x, uint64_t seed) {
    return testing::BumpyGround(testing::RoverPose(x, 0.0, 0.1 * x),
                                {.num_columns = 120, .num_rows = 24, .noise_seed = seed});
  };
  const Scan source = ground(0.3, 1);
  const Scan target = ground(0.0, 2);
  for (const std::string_view name : {"curvelet", "paper", "fpfh-sac-ia", "harris3d-fpfh", "icp"}) {
    SCOPED_TRACE(name);
    const std::optional<Method> method = MethodFromName(name);
    ASSERT_TRUE(method.has_value());
    EXPECT_EQ(MethodName(*method), name);
    RegistrationOptions options;
    options.method = *method;
    const auto result = RegisterScans(source, target, options);
    if (absl::IsUnimplemented(result.status())) continue;  // a build without PCL; it says which method
    ASSERT_THAT(result, IsOk());
    EXPECT_EQ(result->verdict.accepted, result->verdict.reasons.empty());
    EXPECT_THAT(result->verdict.reasons, Not(Contains(Reason::kNotRun)));
    EXPECT_FALSE(result->stage_times.empty());
  }
  EXPECT_EQ(AllMethods().size(), 5U);
  EXPECT_FALSE(MethodFromName("Curvelet").has_value());
  EXPECT_FALSE(MethodFromName("").has_value());
}

}  // namespace
}  // namespace curvereg
