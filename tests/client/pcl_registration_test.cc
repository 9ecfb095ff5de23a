// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/pcl.h"  // what users include

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <limits>
#include <stop_token>
#include <vector>

#include "tests/testing/matchers.h"
#include "tests/testing/result_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using testing::HasCode;
using testing::IsNear;
using testing::IsOk;
using ::testing::Not;

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Registration = CurveletRegistration<pcl::PointXYZ, pcl::PointXYZ>;

const RigidTransform& PoseA() {
  static const RigidTransform T_world_a = testing::RoverPose(3.0, 1.0, 0.4);
  return T_world_a;
}
const RigidTransform& PoseB() {
  static const RigidTransform T_world_b = testing::RoverPose(0.0, 0.0, 0.0);
  return T_world_b;
}

const Scan& ScanA() {
  static const Scan scan = testing::BumpyGround(PoseA(), {.noise_seed = 1});
  return scan;
}
const Scan& ScanB() {
  static const Scan scan = testing::BumpyGround(PoseB(), {.noise_seed = 2});
  return scan;
}
const Scan& ScanElsewhere() {
  static const Scan scan = testing::BumpyGround(testing::RoverPose(0.0, 0.0, 0.0, 1.6, /*world_seed=*/7),
                                                {.noise_seed = 3, .world_seed = 7});
  return scan;
}

RegistrationOptions WithMethod(Method method) {
  RegistrationOptions options;
  options.method = method;
  return options;
}

Cloud::Ptr CloudOf(const Scan& scan) { return pcl::make_shared<Cloud>(PclCloudFromScan(scan)); }

RigidTransform FinalTransformation(Registration& registration) {
  return RigidTransform(registration.getFinalTransformation().cast<double>());
}

// What PCL's getFitnessScore says of a pose of scan A: the mean of the squared distances [m^2] to the nearest point of
// scan B, without those above the limit, which PCL compares with the squares.
constexpr double kMaxSquaredDistance = 0.25;
double FitnessOf(const RigidTransform& T_b_a) {
  pcl::search::KdTree<pcl::PointXYZ> tree;
  tree.setInputCloud(CloudOf(ScanB()));
  double sum = 0.0;
  int count = 0;
  pcl::Indices nearest(1);
  std::vector<float> squared_distance(1);
  for (const pcl::PointXYZ& point : PclCloudFromScan(TransformScan(ScanA(), T_b_a))) {
    if (tree.nearestKSearch(point, 1, nearest, squared_distance) == 0) continue;
    if (squared_distance[0] > kMaxSquaredDistance) continue;
    sum += squared_distance[0];
    ++count;
  }
  return sum / count;
}

// align() with what it must leave behind whenever there is no accepted pose.
void AlignInVain(Registration& registration, const Eigen::Matrix4f& guess = Eigen::Matrix4f::Identity()) {
  Cloud aligned;
  registration.align(aligned, guess);
  EXPECT_FALSE(registration.hasConverged());
  EXPECT_EQ(registration.getFinalTransformation(), Eigen::Matrix4f::Identity());
  EXPECT_FALSE(registration.result().verdict.accepted);
}

TEST(PclRegistrationTest, StandsWherePclsOwnRegistrationsStood) {
  Registration registration;
  pcl::Registration<pcl::PointXYZ, pcl::PointXYZ>& base = registration;
  base.setInputSource(CloudOf(ScanA()));
  base.setInputTarget(CloudOf(ScanB()));
  EXPECT_FALSE(base.hasConverged());
  Cloud aligned;
  base.align(aligned);
  ASSERT_TRUE(base.hasConverged());
  EXPECT_THAT(registration.status(), IsOk());
  EXPECT_TRUE(registration.result().verdict.accepted);
  EXPECT_EQ(registration.getClassName(), "CurveletRegistration");

  const RigidTransform T_b_a = PoseB().inverse() * PoseA();
  EXPECT_THAT(FinalTransformation(registration), IsNear(T_b_a, 0.05, 0.01));
  // The output is the source in the target's frame.
  ASSERT_EQ(aligned.size(), ScanA().points.size());
  const Eigen::Vector3d point = T_b_a * ScanA().points[1000].cast<double>();
  EXPECT_LT((aligned[1000].getVector3fMap().cast<double>() - point).norm(), 0.2);
  EXPECT_NEAR(base.getFitnessScore(kMaxSquaredDistance), FitnessOf(T_b_a), 0.02 * FitnessOf(T_b_a));
}

TEST(PclRegistrationTest, AnswersAsRegisterScansDoes) {
  RegistrationOptions options;
  options.seed = 7;
  Registration registration(options);
  registration.setInputSource(CloudOf(ScanA()));
  registration.setInputTarget(CloudOf(ScanB()));
  Cloud aligned;
  registration.align(aligned);
  const absl::StatusOr<RegistrationResult> expected = RegisterScans(ScanA(), ScanB(), options);
  ASSERT_THAT(expected, IsOk());
  EXPECT_TRUE(testing::BytesOf(registration.result()) == testing::BytesOf(*expected));
  EXPECT_EQ(registration.getFinalTransformation(), expected->T_target_source->matrix().cast<float>());
}

TEST(PclRegistrationTest, DoesNotConvergeForTwoPlaces) {
  Registration registration;
  registration.setInputSource(CloudOf(ScanA()));
  registration.setInputTarget(CloudOf(ScanB()));
  Cloud aligned;
  registration.align(aligned);
  ASSERT_TRUE(registration.hasConverged());  // and nothing of this remains:

  registration.setInputTarget(CloudOf(ScanElsewhere()));
  AlignInVain(registration);
  EXPECT_THAT(registration.status(), IsOk());  // an answer, not an error
  EXPECT_THAT(registration.result().verdict.reasons, Not(Contains(Reason::kNotRun)));
  registration.align(aligned);
  EXPECT_EQ(aligned[1000].getVector3fMap(), ScanA().points[1000]);
  EXPECT_GT(registration.getFitnessScore(), 0.0);  // harmless
}

TEST(PclRegistrationTest, RegistersManySourcesWithOneTarget) {
  Registration registration;
  registration.setInputTarget(CloudOf(ScanB()));
  Cloud aligned;
  for (const Scan* source : {&ScanA(), &ScanElsewhere(), &ScanA()}) {
    registration.setInputSource(CloudOf(*source));
    registration.align(aligned);
    const absl::StatusOr<RegistrationResult> expected = RegisterScans(*source, ScanB());
    ASSERT_THAT(expected, IsOk());
    EXPECT_TRUE(testing::BytesOf(registration.result()) == testing::BytesOf(*expected));
    EXPECT_EQ(registration.hasConverged(), source == &ScanA());
  }
}

TEST(PclRegistrationTest, PreparesATargetOnce) {
  // Seen from outside: a target that is changed without being set again is not looked at again.
  Registration registration;
  const Cloud::Ptr target = CloudOf(ScanB());
  registration.setInputSource(CloudOf(ScanA()));
  registration.setInputTarget(target);
  Cloud aligned;
  registration.align(aligned);
  ASSERT_TRUE(registration.hasConverged());
  *target = *CloudOf(ScanElsewhere());
  registration.align(aligned);
  EXPECT_TRUE(registration.hasConverged());
  registration.setInputTarget(target);
  AlignInVain(registration);
}

TEST(PclRegistrationTest, TakesTheIndicesOfTheSource) {
  // Every second point is the scan's, the others are far from anything.
  Scan mixed;
  const auto indices = pcl::make_shared<pcl::Indices>();
  for (const Eigen::Vector3f& point : ScanA().points) {
    indices->push_back(static_cast<int>(mixed.points.size()));
    mixed.points.push_back(point);
    mixed.points.push_back(point + Eigen::Vector3f(0.0F, 0.0F, 1000.0F));
  }
  Registration registration;
  registration.setInputSource(CloudOf(mixed));
  registration.setIndices(indices);
  registration.setInputTarget(CloudOf(ScanB()));
  Cloud aligned;
  registration.align(aligned);
  ASSERT_TRUE(registration.hasConverged());
  EXPECT_EQ(aligned.size(), ScanA().points.size());
  EXPECT_THAT(FinalTransformation(registration), IsNear(PoseB().inverse() * PoseA(), 0.05, 0.01));
}

TEST(PclRegistrationTest, TakesNoReturnsAndTurnsNormals) {
  auto source = pcl::make_shared<pcl::PointCloud<pcl::PointNormal>>(PclCloudFromScan<pcl::PointNormal>(ScanA()));
  for (pcl::PointNormal& point : *source) point.normal_x = 1.0F;
  (*source)[5].x = std::numeric_limits<float>::quiet_NaN();
  source->is_dense = false;
  CurveletRegistration<pcl::PointNormal, pcl::PointNormal> registration;
  registration.setInputSource(source);
  registration.setInputTarget(
      pcl::make_shared<pcl::PointCloud<pcl::PointNormal>>(PclCloudFromScan<pcl::PointNormal>(ScanB())));
  pcl::PointCloud<pcl::PointNormal> aligned;
  registration.align(aligned);
  ASSERT_TRUE(registration.hasConverged());
  EXPECT_EQ(registration.result().evidence.num_source_points, static_cast<int64_t>(source->size()) - 1);
  const RigidTransform T_b_a = PoseB().inverse() * PoseA();
  EXPECT_THAT(RigidTransform(registration.getFinalTransformation().cast<double>()), IsNear(T_b_a, 0.05, 0.01));
  // Normals turn with the points.
  const Eigen::Vector3d normal = T_b_a.linear() * Eigen::Vector3d::UnitX();
  EXPECT_LT((aligned[1000].getNormalVector3fMap().cast<double>() - normal).norm(), 0.02);
}

TEST(PclRegistrationTest, TakesAGuessAsThePrior) {
  // ICP starts from the prior and needs a good one: here the sensor has nearly turned back.
  const RigidTransform T_world_turned = testing::RoverPose(3.0, 1.0, 2.5);
  const RigidTransform T_b_a = PoseB().inverse() * T_world_turned;
  RigidTransform guess = T_b_a;
  guess.translation() += Eigen::Vector3d(0.1, -0.1, 0.0);
  Registration registration(WithMethod(Method::kIcp));
  registration.setInputSource(CloudOf(testing::BumpyGround(T_world_turned, {.noise_seed = 1})));
  registration.setInputTarget(CloudOf(ScanB()));
  Cloud aligned;
  registration.align(aligned, guess.matrix().cast<float>());
  ASSERT_TRUE(registration.hasConverged());
  EXPECT_THAT(FinalTransformation(registration), IsNear(T_b_a, 0.05, 0.01));
  AlignInVain(registration);  // the identity is no guess here
}

TEST(PclRegistrationTest, AGuessKeepsTheCovarianceOfThePrior) {
  // A prior that is sure of a pose 2 m off forbids the true one; as the guess, the true one is what is sure.
  const RigidTransform T_b_a = PoseB().inverse() * PoseA();
  RigidTransform wrong = T_b_a;
  wrong.translation() += Eigen::Vector3d(2.0, 0.0, 0.0);
  RegistrationOptions options;
  options.prior = Prior{.T_target_source = wrong, .covariance = Matrix6d(Matrix6d::Identity() * 1e-4)};
  Registration registration(options);
  registration.setInputSource(CloudOf(ScanA()));
  registration.setInputTarget(CloudOf(ScanB()));
  AlignInVain(registration);
  Cloud aligned;
  registration.align(aligned, T_b_a.matrix().cast<float>());
  EXPECT_TRUE(registration.hasConverged());
  AlignInVain(registration, wrong.matrix().cast<float>());
}

TEST(PclRegistrationTest, RefusesAGuessThatIsNotRigid) {
  Registration registration;
  registration.setInputSource(CloudOf(ScanA()));
  registration.setInputTarget(CloudOf(ScanB()));
  for (const float value : {2.0F, std::numeric_limits<float>::quiet_NaN()}) {
    Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
    guess(0, 0) = value;
    AlignInVain(registration, guess);
    EXPECT_THAT(registration.status(), HasCode(absl::StatusCode::kInvalidArgument));
    EXPECT_THAT(registration.result().verdict.reasons, ElementsAre(Reason::kNotRun));
  }
}

TEST(PclRegistrationTest, TellsWhyACallCannotBeDone) {
  Registration registration;
  Scan one_point;
  one_point.points = {{1.0F, 2.0F, 3.0F}};
  registration.setInputSource(CloudOf(one_point));
  registration.setInputTarget(CloudOf(ScanB()));
  AlignInVain(registration);
  EXPECT_THAT(registration.status(), HasCode(absl::StatusCode::kInvalidArgument));

  registration.setInputSource(CloudOf(ScanA()));
  std::stop_source stopped;
  stopped.request_stop();
  RegistrationOptions options;
  options.cancellation = stopped.get_token();
  registration.setOptions(options);
  AlignInVain(registration);
  EXPECT_THAT(registration.status(), HasCode(absl::StatusCode::kCancelled));

  registration.setOptions({});
  Cloud aligned;
  registration.align(aligned);
  EXPECT_TRUE(registration.hasConverged());
  EXPECT_THAT(registration.status(), IsOk());
}

TEST(PclRegistrationTest, SetOptionsAppliesToATargetThatIsPrepared) {
  Registration registration;
  registration.setInputSource(CloudOf(ScanA()));
  registration.setInputTarget(CloudOf(ScanB()));
  Cloud aligned;
  registration.align(aligned);
  ASSERT_TRUE(registration.hasConverged());
  RegistrationOptions options;
  options.limits.max_coordinate_m = 1.0;
  registration.setOptions(options);
  EXPECT_EQ(registration.options().limits.max_coordinate_m, 1.0);
  AlignInVain(registration);
  EXPECT_THAT(registration.status(), HasCode(absl::StatusCode::kInvalidArgument));
}

TEST(PclRegistrationTest, ForgetsACloudWhenItIsGivenAnEmptyOne) {
  Registration registration;
  const auto align_both = [&] {
    registration.setInputSource(CloudOf(ScanA()));
    registration.setInputTarget(CloudOf(ScanB()));
    Cloud aligned;
    registration.align(aligned);
    ASSERT_TRUE(registration.hasConverged());
  };
  align_both();
  registration.setInputSource(pcl::make_shared<Cloud>());
  AlignInVain(registration);
  align_both();
  registration.setInputTarget(pcl::make_shared<Cloud>());
  AlignInVain(registration);
}

TEST(PclRegistrationTest, RunsMethodsThatPrepareNothing) {
  if (!IsAvailable(Method::kPaper)) GTEST_SKIP() << "this build leaves the method out";
  Registration registration(WithMethod(Method::kPaper));
  registration.setInputSource(CloudOf(ScanA()));
  registration.setInputTarget(CloudOf(ScanB()));
  Cloud aligned;
  registration.align(aligned);
  const absl::StatusOr<RegistrationResult> expected = RegisterScans(ScanA(), ScanB(), WithMethod(Method::kPaper));
  ASSERT_THAT(expected, IsOk());
  EXPECT_TRUE(testing::BytesOf(registration.result()) == testing::BytesOf(*expected));
}

}  // namespace
}  // namespace curvereg
