// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/register_scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <thread>

#include "tests/testing/matchers.h"
#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using ::testing::Contains;
using testing::HasCode;
using testing::IsNear;
using testing::IsOk;
using ::testing::Not;

constexpr auto kInvalidArgument = absl::StatusCode::kInvalidArgument;

struct Pair {
  Scan source;
  Scan target;
  RigidTransform T_target_source;
};

Pair GroundPair(const RigidTransform& T_world_source, const RigidTransform& T_world_target) {
  return {testing::BumpyGround(T_world_source, {.noise_seed = 1}),
          testing::BumpyGround(T_world_target, {.noise_seed = 2}), T_world_target.inverse() * T_world_source};
}

const Pair& NearPair() {
  static const Pair pair = GroundPair(testing::RoverPose(3.0, 1.0, 0.4), testing::RoverPose(0.0, 0.0, 0.0));
  return pair;
}

Scan Scattered(int num_points, uint64_t seed) {
  testing::Random random(seed);
  Scan scan;
  for (int i = 0; i < num_points; ++i) {
    scan.points.emplace_back(static_cast<float>(random.Uniform(-40.0, 40.0)),
                             static_cast<float>(random.Uniform(-40.0, 40.0)),
                             static_cast<float>(random.Uniform(-40.0, 40.0)));
  }
  return scan;
}

// What every answer promises, whatever the scans.
void ExpectConsistent(const RegistrationResult& result) {
  EXPECT_EQ(result.verdict.accepted, result.verdict.reasons.empty());
  EXPECT_TRUE(result.T_target_source.has_value() || !result.verdict.accepted);
  EXPECT_TRUE(IsRigid(result.T_target_source.value_or(RigidTransform::Identity())));
  EXPECT_TRUE(result.covariance.value_or(Matrix6d::Zero()).allFinite());
  EXPECT_GE(result.total_seconds, 0.0);
  EXPECT_EQ(result.source_digest.size(), 16U);
  EXPECT_EQ(result.options_digest.size(), 16U);
  EXPECT_EQ(result.build_id, BuildId());
}

TEST(RegisterScansTest, AlignsUnevenGroundToItself) {
  for (const double yaw : {0.4, -2.5}) {
    const Pair pair = GroundPair(testing::RoverPose(3.0, 1.0, yaw), testing::RoverPose(0.0, 0.0, 0.0));
    const auto result = RegisterScans(pair.source, pair.target);
    ASSERT_THAT(result, IsOk());
    ExpectConsistent(*result);
    EXPECT_TRUE(result->verdict.accepted) << ReasonName(result->verdict.reasons.front());
    EXPECT_THAT(result->T_target_source, IsNear(pair.T_target_source, 0.03, 0.003));
    EXPECT_TRUE(result->degenerate_directions.empty());
    EXPECT_EQ(result->evidence.num_source_points, static_cast<int64_t>(pair.source.points.size()));
    EXPECT_GT(result->evidence.num_inliers, 10);
    EXPECT_GT(result->evidence.free_space_agreement, 0.9);
    EXPECT_FALSE(result->stage_times.empty());
  }
}

TEST(RegisterScansTest, AlignsAHallToItself) {
  testing::ScannerOptions scanner;
  scanner.max_elevation_rad = 0.7;
  const RigidTransform T_world_source = testing::UprightPose(-1.5, 0.6, 1.0, 1.3);
  const RigidTransform T_world_target = testing::UprightPose(0.5, 0.2, 0.3);
  const auto result =
      RegisterScans(testing::FurnishedHall(T_world_source, scanner), testing::FurnishedHall(T_world_target, scanner));
  ASSERT_THAT(result, IsOk());
  ExpectConsistent(*result);
  EXPECT_TRUE(result->verdict.accepted) << ReasonName(result->verdict.reasons.front());
  EXPECT_THAT(result->T_target_source, IsNear(T_world_target.inverse() * T_world_source, 0.02, 0.003));
}

TEST(RegisterScansTest, AnyAttitudeOfTheSensorWillDo) {
  const Pair& pair = NearPair();
  RigidTransform T_turned_source = RigidTransform::Identity();
  T_turned_source.linear() = RotationFromVector({1.3, -0.9, 2.0});
  const auto result = RegisterScans(TransformScan(pair.source, T_turned_source), pair.target);
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->T_target_source, IsNear(pair.T_target_source * T_turned_source.inverse(), 0.03, 0.003));
}

TEST(RegisterScansTest, AScanLiesOnItselfAtIdentity) {
  const auto result = RegisterScans(NearPair().source, NearPair().source);
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->T_target_source, IsNear(RigidTransform::Identity(), 1e-3, 1e-4));
  EXPECT_EQ(result->source_digest, result->target_digest);
}

TEST(RegisterScansTest, DoesNotAcceptScansOfDifferentPlaces) {
  for (const uint64_t world : {2U, 3U, 4U}) {
    const Scan other = testing::BumpyGround(testing::RoverPose(1.0, 2.0, 0.5, 1.6, world), {.world_seed = world});
    const auto result = RegisterScans(other, NearPair().target);
    ASSERT_THAT(result, IsOk());
    ExpectConsistent(*result);
    EXPECT_FALSE(result->verdict.accepted) << "world " << world;
  }
}

TEST(RegisterScansTest, OnAFlatPlainPlaceAndYawAreCalledDegenerate) {
  const auto result = RegisterScans(testing::FlatGround(testing::UprightPose(2.0, 1.0, 0.4), {.noise_seed = 1}),
                                    testing::FlatGround(testing::UprightPose(0.0, 0.0, 0.0), {.noise_seed = 2}));
  ASSERT_THAT(result, IsOk());
  ExpectConsistent(*result);
  EXPECT_FALSE(result->verdict.accepted);
  EXPECT_THAT(result->verdict.reasons, Contains(Reason::kDegenerateDirection));
  EXPECT_EQ(result->degenerate_directions.size(), 3U);
}

TEST(RegisterScansTest, NonsenseIsRejectedNotRefused) {
  std::vector<Scan> scans = {Scattered(200, 1), Scattered(20000, 2)};
  Scan plate;
  plate.points = testing::PatchPoints({.centre = {3.0, 0.0, 0.0}, .side_m = 0.01}, 500, 3);
  scans.push_back(plate);
  Scan holes = NearPair().source;
  for (size_t i = 0; i < holes.points.size(); i += 2)
    holes.points[i].setConstant(std::numeric_limits<float>::quiet_NaN());
  holes.points[1].setConstant(std::numeric_limits<float>::infinity());
  for (const Scan& scan : scans) {
    for (const auto& [source, target] : {std::pair(&scan, &scan), {&scan, &NearPair().target}, {&holes, &scan}}) {
      const auto result = RegisterScans(*source, *target);
      ASSERT_THAT(result, IsOk());
      ExpectConsistent(*result);
      if (source != target) {
        EXPECT_FALSE(result->verdict.accepted);
      }
    }
  }
  const auto result = RegisterScans(holes, NearPair().target);
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
}

TEST(RegisterScansTest, RefusesWhatIsNoScan) {
  const Scan& good = NearPair().target;
  Scan line, equal, gravity = good;
  for (int i = 0; i < 1000; ++i) line.points.emplace_back(0.01F * static_cast<float>(i), 1.0F, 2.0F);
  equal.points.assign(1000, {1.0F, 2.0F, 3.0F});
  gravity.gravity = Eigen::Vector3d::Zero();
  for (const Scan& bad : {Scan{}, line, equal, gravity, Scattered(5, 1)}) {
    EXPECT_THAT(RegisterScans(bad, good), HasCode(kInvalidArgument));
    EXPECT_THAT(RegisterScans(good, bad), HasCode(kInvalidArgument));
  }
}

TEST(RegisterScansTest, RefusesBadOptions) {
  const auto code_of = [](auto spoil) {
    RegistrationOptions options;
    spoil(options);
    return RegisterScans(NearPair().source, NearPair().target, options);
  };
  EXPECT_THAT(code_of([](auto& options) { options.num_threads = -1; }), HasCode(kInvalidArgument));
  EXPECT_THAT(code_of([](auto& options) { options.time_budget_s = 0.0; }), HasCode(kInvalidArgument));
  EXPECT_THAT(code_of([](auto& options) { options.time_budget_s = std::nan(""); }), HasCode(kInvalidArgument));
  EXPECT_THAT(code_of([](auto& options) {
                options.prior.emplace();
                options.prior->T_target_source.linear() *= 2.0;
              }),
              HasCode(kInvalidArgument));
  EXPECT_THAT(code_of([](auto& options) {
                options.prior.emplace();
                options.prior->covariance = -Matrix6d::Identity();
              }),
              HasCode(kInvalidArgument));
  EXPECT_THAT(code_of([](auto& options) { options.limits.max_points = 10; }), HasCode(kInvalidArgument));
}

TEST(RegisterScansTest, PreparedScansGiveTheSameAnswer) {
  const Pair& pair = NearPair();
  const auto source = PreparedScan::Create(std::make_shared<Scan>(pair.source));
  const auto target = PreparedScan::Create(std::make_shared<Scan>(pair.target));
  const auto expected = RegisterScans(pair.source, pair.target);
  for (int i = 0; i < 2; ++i) {  // the second time the views are there already
    const auto result = RegisterPreparedScans(**source, **target);
    ASSERT_THAT(result, IsOk());
    EXPECT_EQ(result->T_target_source->matrix(), expected->T_target_source->matrix());
    EXPECT_EQ(result->covariance, expected->covariance);
    EXPECT_EQ(result->source_digest, expected->source_digest);
  }
}

TEST(RegisterScansTest, CancelledBeforeOrMeanwhile) {
  std::stop_source before;
  before.request_stop();
  RegistrationOptions options;
  options.cancellation = before.get_token();
  EXPECT_THAT(RegisterScans(NearPair().source, NearPair().target, options), HasCode(absl::StatusCode::kCancelled));

  // Scans of different places run every escalation step; cancelled at many moments, none is accepted or takes long.
  const Scan other = testing::BumpyGround(testing::RoverPose(1.0, 2.0, 0.5, 1.6, 2), {.world_seed = 2});
  for (const int milliseconds : {1, 5, 15, 40}) {
    std::stop_source source;
    options.cancellation = source.get_token();
    std::jthread canceller([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
      source.request_stop();
    });
    const auto result = RegisterScans(other, NearPair().target, options);
    if (result.ok()) {
      EXPECT_FALSE(result->verdict.accepted);  // it was quicker
    } else {
      EXPECT_THAT(result, HasCode(absl::StatusCode::kCancelled));
    }
  }
}

TEST(RegisterScansTest, AtTheDeadlineTheAnswerIsMarked) {
  const Scan other = testing::BumpyGround(testing::RoverPose(1.0, 2.0, 0.5, 1.6, 2), {.world_seed = 2});
  const auto whole = RegisterScans(other, NearPair().target);
  ASSERT_THAT(whole, IsOk());
  for (const double share : {1e-9, 0.02, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}) {
    RegistrationOptions options;
    options.time_budget_s = share * whole->total_seconds;
    const auto result = RegisterScans(other, NearPair().target, options);
    ASSERT_THAT(result, IsOk());
    ExpectConsistent(*result);
    EXPECT_FALSE(result->verdict.accepted);
    if (result->evidence.num_attempts < whole->evidence.num_attempts) {
      EXPECT_THAT(result->verdict.reasons, Contains(Reason::kDeadline).Times(1)) << share;
    }
  }
  RegistrationOptions generous;
  generous.time_budget_s = 1000.0;
  const auto result = RegisterScans(NearPair().source, NearPair().target, generous);
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->verdict.reasons, Not(Contains(Reason::kDeadline)));
}

TEST(RegisterScansTest, DigestsTellOptionsAndScansApart) {
  const Pair& pair = NearPair();
  RegistrationOptions seeded;
  seeded.seed = 7;
  RegistrationOptions threaded;
  threaded.num_threads = 1;
  const auto plain = RegisterScans(pair.source, pair.target);
  EXPECT_NE(RegisterScans(pair.source, pair.target, seeded)->options_digest, plain->options_digest);
  EXPECT_EQ(RegisterScans(pair.source, pair.target, threaded)->options_digest, plain->options_digest);
  EXPECT_NE(plain->source_digest, plain->target_digest);
  EXPECT_EQ(plain->source_digest, ScanDigest(pair.source));
}

TEST(RegisterScansTest, SameBytesAtAnyThreadCount) {
  const Scan other = testing::BumpyGround(testing::RoverPose(1.0, 2.0, 0.5, 1.6, 2), {.world_seed = 2});
  std::string serial;
  for (const int num_threads : {1, 2, 4}) {
    testing::ByteLog log;
    for (const Scan* source : {&NearPair().source, &other}) {
      RegistrationOptions options;
      options.num_threads = num_threads;
      const auto result = RegisterScans(*source, NearPair().target, options);
      ASSERT_THAT(result, IsOk());
      log.Add(result->T_target_source.value_or(RigidTransform::Identity()).data(), 16);
      log.Add(result->covariance.value_or(Matrix6d::Zero()).data(), 36);
      log.Add(result->evidence.image_correlation.value_or(-1.0));
      log.Add(result->evidence.runner_up_ratio.value_or(-1.0));
      log.Add(result->evidence.num_hypotheses);
      for (const Reason reason : result->verdict.reasons) log.Add(static_cast<int>(reason));
    }
    if (num_threads == 1) serial = log.bytes();
    EXPECT_TRUE(log.bytes() == serial) << "differs with " << num_threads << " threads";
  }
}

TEST(RegisterScansTest, ADeadlineOfTheCallEndsTheSearchAndLeavesTheDigestAlone) {
  RegistrationOptions options;
  const auto free = RegisterScans(NearPair().source, NearPair().target, options);
  ASSERT_THAT(free, IsOk());
  options.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  const auto late = RegisterScans(NearPair().source, NearPair().target, options);
  ASSERT_THAT(late, IsOk());
  EXPECT_THAT(late->verdict.reasons, Contains(Reason::kDeadline));
  EXPECT_FALSE(late->T_target_source.has_value());
  EXPECT_EQ(late->options_digest, free->options_digest);
  EXPECT_EQ(late->source_digest, free->source_digest);
  EXPECT_EQ(late->evidence.num_target_points, free->evidence.num_target_points);

  options.deadline = std::chrono::steady_clock::now() + std::chrono::hours(1);
  options.time_budget_s = 1e-9;  // the nearer of the two counts
  const auto short_of_budget = RegisterScans(NearPair().source, NearPair().target, options);
  ASSERT_THAT(short_of_budget, IsOk());
  EXPECT_THAT(short_of_budget->verdict.reasons, Contains(Reason::kDeadline));
}

ScanPreparation PreparationOf(const Scan& scan) {
  return [&](const Stop& stop) { return PreparedScan::Create(std::make_shared<const Scan>(scan), {}, stop); };
}

TEST(RegisterScansTest, PreparesByOtherHandsAndAnswersTheSame) {
  RegistrationOptions options;
  const auto direct = RegisterScans(NearPair().source, NearPair().target, options);
  ASSERT_THAT(direct, IsOk());
  const ScanPreparation source = PreparationOf(NearPair().source);
  const auto prepared = PrepareAndRegister(source, PreparationOf(NearPair().target), options);
  ASSERT_THAT(prepared, IsOk());
  EXPECT_EQ(prepared->T_target_source->matrix(), direct->T_target_source->matrix());
  EXPECT_EQ(prepared->target_digest, direct->target_digest);
  EXPECT_EQ(prepared->evidence.num_source_points, direct->evidence.num_source_points);
  EXPECT_EQ(prepared->stage_times.front().stage, "preparation");
  EXPECT_GE(prepared->total_seconds, prepared->stage_times.front().seconds);

  const ScanPreparation fails = [](const Stop&) { return absl::NotFoundError("no such scan"); };
  EXPECT_THAT(PrepareAndRegister(source, fails, options), HasCode(absl::StatusCode::kNotFound));
  const ScanPreparation slow = [](const Stop&) { return absl::DeadlineExceededError("out of time"); };
  const auto late = PrepareAndRegister(source, slow, options);
  ASSERT_THAT(late, IsOk());
  EXPECT_EQ(late->verdict.reasons, std::vector<Reason>{Reason::kDeadline});
  EXPECT_EQ(late->options_digest, direct->options_digest);
  EXPECT_EQ(late->build_id, direct->build_id);
  options.method = Method::kPaper;
  EXPECT_THAT(PrepareAndRegister(source, source, options), HasCode(absl::StatusCode::kInvalidArgument));
}

TEST(RegisterScansTest, TellsWhichMethodsThisBuildHas) {
  for (const Method method : AllMethods()) {
    RegistrationOptions options;
    options.method = method;
    options.time_budget_s = 1e-9;
    const auto result = RegisterScans(NearPair().source, NearPair().target, options);
    EXPECT_EQ(absl::IsUnimplemented(result.status()), !IsAvailable(method)) << MethodName(method);
  }
}

}  // namespace
}  // namespace curvereg
