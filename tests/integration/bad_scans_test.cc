// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Scans that are none, or hardly, or too much of one: a clear answer, never a crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/register_scans.h"
#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"
#include "tests/testing/simulated.h"

namespace curvereg {
namespace {

using testing::HasCode;
using ::testing::HasSubstr;
using testing::IsNear;
using testing::IsOk;
using testing::ScanPairWithTruth;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

const ScanPairWithTruth& YardPair() {
  static const ScanPairWithTruth pair = testing::PairOf("mars-yard-sim", 3, 2);
  return pair;
}

class BadScansTest : public ::testing::TestWithParam<Method> {
 protected:
  static absl::StatusOr<RegistrationResult> Register(const Scan& source, const Scan& target) {
    RegistrationOptions options;
    options.method = GetParam();
    return RegisterScans(source, target, options);
  }

  // As source, as target and as both.
  static void ExpectRefused(const Scan& bad, const std::string& words) {
    SCOPED_TRACE(words);
    for (const auto& [source, target] :
         {std::pair(&bad, &YardPair().target), {&YardPair().source, &bad}, {&bad, &bad}}) {
      const auto result = Register(*source, *target);
      EXPECT_THAT(result, HasCode(absl::StatusCode::kInvalidArgument));
      EXPECT_THAT(std::string(result.status().message()), HasSubstr(words));
    }
  }

  static void ExpectRejected(const Scan& odd) {
    for (const auto& [source, target] : {std::pair(&odd, &YardPair().target), {&YardPair().source, &odd}}) {
      const auto result = Register(*source, *target);
      ASSERT_THAT(result, IsOk());
      EXPECT_FALSE(result->verdict.accepted);
      EXPECT_FALSE(result->verdict.reasons.empty());
      EXPECT_TRUE(IsRigid(result->T_target_source.value_or(RigidTransform::Identity())));
      EXPECT_TRUE(result->covariance.value_or(Matrix6d::Zero()).allFinite());
    }
  }
};

TEST_P(BadScansTest, Empty) { ExpectRefused({}, "0 finite points"); }

TEST_P(BadScansTest, OnePoint) { ExpectRefused({{{1.0F, 2.0F, 3.0F}}, {}}, "1 finite points"); }

TEST_P(BadScansTest, NothingFinite) {
  Scan scan;
  scan.points.assign(5000, {kNan, kInfinity, -kInfinity});
  ExpectRefused(scan, "0 finite points");
}

TEST_P(BadScansTest, AllPointsEqual) {
  for (const float value : {0.0F, 3.25F, -5e4F}) {
    Scan scan;
    scan.points.assign(5000, {value, -value, 0.5F * value});
    ExpectRefused(scan, "equal");
  }
}

TEST_P(BadScansTest, AllPointsOnALine) {
  for (const Eigen::Vector3f& direction : {Eigen::Vector3f(1.0F, 0.0F, 0.0F), Eigen::Vector3f(0.3F, -0.7F, 0.2F)}) {
    Scan scan;
    for (int i = 0; i < 5000; ++i) {
      scan.points.push_back(Eigen::Vector3f(4.0F, 1.0F, -2.0F) + 0.01F * static_cast<float>(i) * direction);
    }
    ExpectRefused(scan, "line");
  }
}

TEST_P(BadScansTest, NotInMetres) {
  Scan scan = YardPair().source;
  for (Eigen::Vector3f& point : scan.points) point *= 1e5F;
  ExpectRefused(scan, "metres");
}

TEST_P(BadScansTest, HugeButFinite) {
  Scan scan = YardPair().source;
  scan.points[7] = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
  ExpectRefused(scan, "metres");
}

TEST_P(BadScansTest, NearlyNothing) {
  testing::Random random(3);
  Scan few, plate, ring;
  for (int i = 0; i < 150; ++i) few.points.push_back(YardPair().source.points[static_cast<size_t>(i) * 1000]);
  plate.points = testing::PatchPoints({.centre = {3.0, 0.0, -1.0}, .side_m = 0.02}, 3000, 4);
  for (int i = 0; i < 3000; ++i) {
    const double angle = 0.002 * i;
    ring.points.push_back(Eigen::Vector3d(8.0 * std::cos(angle), 8.0 * std::sin(angle), -1.8).cast<float>());
  }
  for (const Scan& scan : {few, plate, ring}) ExpectRejected(scan);
}

TEST_P(BadScansTest, PointsAtTheSensor) {
  Scan scan;
  testing::Random random(3);
  for (int i = 0; i < 3000; ++i) {
    scan.points.emplace_back(static_cast<float>(1e-20 * random.Gaussian()),
                             static_cast<float>(1e-20 * random.Gaussian()),
                             static_cast<float>(1e-20 * random.Gaussian()));
  }
  scan.points.insert(scan.points.end(), 3000, Eigen::Vector3f::Zero());
  const auto result = Register(scan, YardPair().target);
  if (result.ok()) {
    EXPECT_FALSE(result->verdict.accepted);
  } else {
    EXPECT_THAT(result, HasCode(absl::StatusCode::kInvalidArgument));
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, BadScansTest, ::testing::Values(Method::kCurvelet, Method::kIcp, Method::kPaper),
                         [](const auto& method) { return std::string(MethodName(method.param)); });

TEST(OddScansTest, PointsThatAreNotFiniteAreSkipped) {
  const ScanPairWithTruth& pair = YardPair();
  ScanPairWithTruth spoilt{{}, {}, pair.T_target_source};
  const std::array<Eigen::Vector3f, 3> bad = {Eigen::Vector3f(kNan, 0.0F, 0.0F), Eigen::Vector3f(1.0F, kInfinity, 2.0F),
                                              Eigen::Vector3f(3.0F, 1.0F, -kInfinity)};
  for (const auto& [clean, dirty] : {std::pair(&pair.source, &spoilt.source), {&pair.target, &spoilt.target}}) {
    for (size_t i = 0; i < clean->points.size(); ++i) {
      if (i % 3 == 0) dirty->points.push_back(bad[i / 3 % 3]);
      dirty->points.push_back(clean->points[i]);
    }
  }
  const auto result = RegisterScans(spoilt.source, spoilt.target);
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->T_target_source, IsNear(pair.T_target_source, 0.01, 0.001));
  EXPECT_EQ(result->evidence.num_source_points, static_cast<int64_t>(pair.source.points.size()));
  EXPECT_EQ(result->evidence.num_target_points, static_cast<int64_t>(pair.target.points.size()));
}

TEST(OddScansTest, AScanLiesOnItself) {
  for (const char* preset : {"mars-yard-sim", "sparse", "outliers", "flat", "mars-dome", "random-yaw"}) {
    SCOPED_TRACE(preset);
    const Scan scan = testing::PairOf(preset, 1, 0).source;
    const auto result = RegisterScans(scan, scan);
    ASSERT_THAT(result, IsOk());
    EXPECT_TRUE(result->verdict.accepted);
    EXPECT_THAT(result->T_target_source, IsNear(RigidTransform::Identity(), 1e-3, 1e-4));
    EXPECT_TRUE(result->degenerate_directions.empty());
  }
}

TEST(OddScansTest, ACopyThatWasTurnedIsFoundAgain) {
  const Scan& scan = YardPair().source;
  for (const Eigen::Vector3d& turn : {Eigen::Vector3d(0.0, 0.0, 2.2), {0.2, -0.1, 3.0}, {3.0, 0.0, 0.0}}) {
    RigidTransform T_turned_scan = RigidTransform::Identity();
    T_turned_scan.linear() = RotationFromVector(turn);
    const auto result = RegisterScans(scan, TransformScan(scan, T_turned_scan));
    ASSERT_THAT(result, IsOk());
    EXPECT_TRUE(result->verdict.accepted);
    EXPECT_THAT(result->T_target_source, IsNear(T_turned_scan, 0.01, 0.001));
  }
}

TEST(OddScansTest, TenMillionPoints) {
  const ScanPairWithTruth& pair = YardPair();
  const auto result =
      RegisterScans(testing::Multiplied(pair.source, 10'000'000), testing::Multiplied(pair.target, 10'000'000));
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->T_target_source, IsNear(pair.T_target_source, 0.05, 0.002));
  EXPECT_EQ(result->evidence.num_source_points, 10'000'000);
  std::printf("two scans of 10 million points: %.2f s\n", result->total_seconds);
}

TEST(OddScansTest, TenMillionPointsOfAnotherPlace) {
  const ScanPairWithTruth pair = testing::PairOf("negatives", 4, 0);
  const auto result =
      RegisterScans(testing::Multiplied(pair.source, 10'000'000), testing::Multiplied(pair.target, 10'000'000));
  ASSERT_THAT(result, IsOk());
  EXPECT_FALSE(result->verdict.accepted);
  std::printf("two scans of 10 million points that share no ground: %.2f s\n", result->total_seconds);
}

}  // namespace
}  // namespace curvereg
