// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/trajectory_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/testing/corrupt_files.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::HasSubstr;
using testing::ReadBytes;
using ::testing::StartsWith;
using testing::TemporaryFolder;
using testing::WriteBytes;

std::vector<StampedPose> OddPoses(std::size_t num_poses) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<StampedPose> poses(num_poses);
  for (std::size_t i = 0; i < num_poses; ++i) {
    Vector6d delta;
    for (double& value : delta) value = uniform(random);
    delta.head<3>() *= 3.0;
    delta.tail<3>() *= 1000.0;
    poses[i] = {1.6e9 + 0.1 * static_cast<double>(i), TransformFromVector(delta)};
  }
  poses.push_back({0.0, RigidTransform::Identity()});
  // Half turns, where the quaternion's w is zero.
  poses.push_back({1.0, TransformFromVector((Vector6d() << 0, 0, std::numbers::pi, 1, 2, 3).finished())});
  return poses;
}

TEST(TrajectoryFileTest, RoundTripsTum) {
  const TemporaryFolder folder;
  const std::vector<StampedPose> poses = OddPoses(50);
  ASSERT_TRUE(WriteTrajectoryFile(folder.File("poses.txt"), poses).ok());
  const auto back = ReadTrajectoryFile(folder.File("poses.txt"));
  ASSERT_TRUE(back.ok()) << back.status();
  ASSERT_EQ(back->size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR((*back)[i].timestamp_s, poses[i].timestamp_s, 1e-9);
    EXPECT_LT(((*back)[i].T_world_scan.translation() - poses[i].T_world_scan.translation()).cwiseAbs().maxCoeff(),
              1e-12);
    EXPECT_LT(((*back)[i].T_world_scan.linear() - poses[i].T_world_scan.linear()).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(TrajectoryFileTest, RoundTripsKitti) {
  const TemporaryFolder folder;
  const std::vector<StampedPose> poses = OddPoses(50);
  ASSERT_TRUE(WriteTrajectoryFile(folder.File("poses.txt"), poses, TrajectoryFormat::kKitti).ok());
  const auto back = ReadTrajectoryFile(folder.File("poses.txt"));
  ASSERT_TRUE(back.ok()) << back.status();
  ASSERT_EQ(back->size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ((*back)[i].timestamp_s, static_cast<double>(i));
    EXPECT_LT(((*back)[i].T_world_scan.matrix() - poses[i].T_world_scan.matrix()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(TrajectoryFileTest, WritesTumWithHeaderAndDecimals) {
  const TemporaryFolder folder;
  StampedPose pose{12.5, TransformFromVector((Vector6d() << 0, 0, std::numbers::pi / 2, 1, -2, 0.125).finished())};
  ASSERT_TRUE(WriteTrajectoryFile(folder.File("a"), {pose}).ok());
  const std::string text = ReadBytes(folder.File("a"));
  EXPECT_THAT(text, StartsWith("# T_world_scan"));
  EXPECT_THAT(text, HasSubstr("\n12.500000000 1.000000000000 -2.000000000000 0.125000000000 0.000000000000000 "
                              "0.000000000000000 0.707106781186547"));
  ASSERT_TRUE(WriteTrajectoryFile(folder.File("b"), {pose}, TrajectoryFormat::kKitti).ok());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_THAT(ReadBytes(folder.File("b")), ::testing::Not(HasSubstr("#")));
}

TEST(TrajectoryFileTest, ReadsTumConvention) {
  // A quarter turn about z: x goes to y.
  const auto poses = ParseTrajectory("# c\n\n1.5\t10 20 30 0 0 0.7071068 0.7071068\r\n");
  ASSERT_TRUE(poses.ok()) << poses.status();
  ASSERT_EQ(poses->size(), 1U);
  EXPECT_EQ((*poses)[0].timestamp_s, 1.5);
  EXPECT_LT(((*poses)[0].T_world_scan * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(10, 21, 30)).norm(), 1e-12);
  EXPECT_TRUE(IsRigid((*poses)[0].T_world_scan, 1e-14));
}

TEST(TrajectoryFileTest, ReadsKittiConvention) {
  const auto poses = ParseTrajectory("1 0 0 1 0 1 0 2 0 0 1 3\n0 -1 0 10 1 0 0 20 0 0 1 30\n");
  ASSERT_TRUE(poses.ok()) << poses.status();
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ((*poses)[0].T_world_scan.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_LT(((*poses)[1].T_world_scan * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(10, 21, 30)).norm(), 1e-12);
}

TEST(TrajectoryFileTest, NamesTheLineThatIsWrong) {
  const std::string good = "0 0 0 0 0 0 0 1\n";
  for (const auto& [line, cause] :
       std::vector<std::pair<std::string, std::string>>{{"0 0 0 0 0 0 1", "7 numbers"},
                                                        {"0 0 0 0 0 0 0 1 1", "9 numbers"},
                                                        {"0 0 0 0 0 0 0 0", "length 0"},
                                                        {"0 0 0 0 0 0 0 2", "length 2"},
                                                        {"0 0 0 0 0 0 zero 1", "'zero' is not a finite number"},
                                                        {"0 nan 0 0 0 0 0 1", "'nan' is not a finite number"},
                                                        {"0 0 0 0 1e300 1e300 0 1", "length inf"},
                                                        {"1 0 0 0 0 1 0 0 0 0 1 0", "the lines before have 8"},
                                                        {"1 2 3 4 5 6 7 8 9 10 11 12 13 14", "13 or more numbers"}}) {
    const absl::Status status = ParseTrajectory("# c\n" + good + line + "\n").status();
    EXPECT_TRUE(absl::IsInvalidArgument(status));
    EXPECT_THAT(std::string(status.message()), StartsWith("line 3: ")) << line;
    EXPECT_THAT(std::string(status.message()), HasSubstr(cause));
  }
  for (const char* matrix : {"2 0 0 0 0 1 0 0 0 0 1 0", "1 0 0 0 0 1 0 0 0 0 -1 0", "0 0 0 0 0 0 0 0 0 0 0 0"}) {
    EXPECT_THAT(std::string(ParseTrajectory(matrix).status().message()), HasSubstr("not a rotation matrix"));
  }
}

TEST(TrajectoryFileTest, RefusesFilesWithoutPoses) {
  EXPECT_TRUE(absl::IsInvalidArgument(ParseTrajectory("").status()));
  EXPECT_TRUE(absl::IsInvalidArgument(ParseTrajectory("# nothing\n").status()));
  const TemporaryFolder folder;
  EXPECT_TRUE(absl::IsNotFound(ReadTrajectoryFile(folder.File("none")).status()));
  WriteBytes(folder.File("bad"), "1 2 3\n");
  EXPECT_THAT(std::string(ReadTrajectoryFile(folder.File("bad")).status().message()),
              StartsWith(folder.File("bad") + ": line 1: "));
}

TEST(TrajectoryFileTest, SurvivesEveryTruncation) {
  const std::string text = "0 1 2 3 0 0 0 1\n1 1 2 3 0 0 1 0\n";
  for (std::size_t length = 0; length < text.size(); ++length) {
    const auto poses = testing::ParseExact(ParseTrajectory, text.substr(0, length));
    if (poses.ok()) {
      EXPECT_LE(poses->size(), 2U);
    }
  }
}

TEST(TrajectoryFileTest, WritesOnlyPoses) {
  const TemporaryFolder folder;
  StampedPose not_finite;
  not_finite.T_world_scan.translation().x() = std::numeric_limits<double>::quiet_NaN();
  StampedPose scaled;
  scaled.T_world_scan.linear() *= 2.0;
  for (const StampedPose& pose : {not_finite, scaled}) {
    const absl::Status status = WriteTrajectoryFile(folder.File("a"), {StampedPose{}, pose});
    EXPECT_TRUE(absl::IsInvalidArgument(status));
    EXPECT_THAT(std::string(status.message()), HasSubstr(folder.File("a") + ": pose 1"));
  }
  EXPECT_TRUE(absl::IsNotFound(ReadTrajectoryFile(folder.File("a")).status()));
}

}  // namespace
}  // namespace curvereg
