// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "absl/strings/str_cat.h"
#include "files/trajectory_file.h"
#include "tests/testing/corrupt_files.h"
#include "tests/testing/ordinary_user.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing::TemporaryFolder;
using testing::WriteBytes;

constexpr char kIdentity[] = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";

// Row-major, a quarter turn about z and a shift.
constexpr char kQuarterTurn[] = "0 -1 0 10 1 0 0 20 0 0 1 30 0 0 0 1";

void AddScans(const TemporaryFolder& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) WriteBytes(folder.File(name), "1 2 3\n");
}

std::string ErrorOf(const TemporaryFolder& folder, const PairSelection& selection = {}) {
  return std::string(LoadDataset(folder.path(), selection).status().message());
}

TEST(DatasetTest, ReadsPairs) {
  const TemporaryFolder folder;
  AddScans(folder, {"b.pcd", "a.pcd", "c.ply"});
  WriteBytes(folder.File("pairs.txt"), absl::StrCat("# source target overlap ...\nb a 0.7 54 0.8 1.6 ", kQuarterTurn,
                                                    "\n\nc\ta\t0.2 ", kIdentity, "\r\nc b ", kIdentity, "\n"));
  const auto dataset = LoadDataset(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.status();
  EXPECT_EQ(dataset->folder, folder.path());
  EXPECT_THAT(dataset->scan_names, ElementsAre("a", "b", "c"));
  EXPECT_THAT(dataset->scan_paths, ElementsAre(folder.File("a.pcd"), folder.File("b.pcd"), folder.File("c.ply")));
  ASSERT_EQ(dataset->T_world_scan.size(), 3U);
  EXPECT_FALSE(dataset->T_world_scan[0].has_value());
  ASSERT_EQ(dataset->pairs.size(), 3U);
  EXPECT_EQ(dataset->pairs[0].source, "b");
  EXPECT_EQ(dataset->pairs[0].target, "a");
  EXPECT_EQ(dataset->pairs[0].overlap, 0.7);
  EXPECT_LT((dataset->pairs[0].T_target_source * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(10, 21, 30)).norm(), 1e-12);
  EXPECT_EQ(dataset->pairs[2].overlap, -1.0);
}

TEST(DatasetTest, LeavesOutPairsOfLittleOverlap) {
  const TemporaryFolder folder;
  AddScans(folder, {"a.pcd", "b.pcd"});
  WriteBytes(folder.File("pairs.txt"),
             absl::StrCat("a b 0.3 ", kIdentity, "\nb a 0.29 ", kIdentity, "\nb a ", kIdentity, "\n"));
  const auto dataset = LoadDataset(folder.path(), {.every = 1, .min_overlap = 0.3});
  ASSERT_TRUE(dataset.ok()) << dataset.status();
  ASSERT_EQ(dataset->pairs.size(), 2U) << "those of unknown overlap stay";
  EXPECT_EQ(dataset->pairs[0].overlap, 0.3);
  EXPECT_EQ(dataset->pairs[1].overlap, -1.0);
}

TEST(DatasetTest, PairsConsecutiveScansOfATrajectory) {
  const TemporaryFolder folder;
  AddScans(folder, {"0002.pcd", "0000.pcd", "0001.pcd"});
  std::vector<StampedPose> poses(3);
  for (std::size_t i = 0; i < 3; ++i) {
    poses[i].timestamp_s = static_cast<double>(i);
    poses[i].T_world_scan =
        TransformFromVector((Vector6d() << 0, 0, 0.5 * poses[i].timestamp_s, poses[i].timestamp_s, 0, 1).finished());
  }
  ASSERT_TRUE(WriteTrajectoryFile(folder.File("poses.txt"), poses).ok());
  const auto every = LoadDataset(folder.path());
  ASSERT_TRUE(every.ok()) << every.status();
  ASSERT_EQ(every->pairs.size(), 2U);
  EXPECT_EQ(every->pairs[1].source, "0002");
  EXPECT_EQ(every->pairs[1].target, "0001");
  EXPECT_TRUE(every->pairs[1].T_target_source.isApprox(poses[1].T_world_scan.inverse() * poses[2].T_world_scan, 1e-12));
  const auto second = LoadDataset(folder.path(), {.every = 2});
  ASSERT_TRUE(second.ok()) << second.status();
  ASSERT_EQ(second->pairs.size(), 1U);
  EXPECT_EQ(second->pairs[0].source, "0002");
  EXPECT_EQ(second->pairs[0].target, "0000");
  EXPECT_TRUE(LoadDataset(folder.path(), {.every = 3})->pairs.empty());
}

TEST(DatasetTest, TakesEveryNthPair) {
  const TemporaryFolder folder;
  AddScans(folder, {"a.pcd", "b.pcd"});
  WriteBytes(folder.File("pairs.txt"),
             absl::StrCat("a b 0.1 ", kIdentity, "\nb a 0.2 ", kIdentity, "\na b 0.3 ", kIdentity, "\n"));
  const auto dataset = LoadDataset(folder.path(), {.take = 2});
  ASSERT_TRUE(dataset.ok()) << dataset.status();
  ASSERT_EQ(dataset->pairs.size(), 2U);
  EXPECT_EQ(dataset->pairs[0].overlap, 0.1);
  EXPECT_EQ(dataset->pairs[1].overlap, 0.3);
  EXPECT_EQ(LoadDataset(folder.path(), {.take = 5})->pairs.size(), 1U);
  EXPECT_TRUE(absl::IsInvalidArgument(LoadDataset(folder.path(), {.take = 0}).status()));
}

TEST(DatasetTest, ReadsPosesByName) {
  const TemporaryFolder folder;
  AddScans(folder, {"a.pcd", "b.pcd", "c.pcd"});
  WriteBytes(folder.File("poses.txt"),
             absl::StrCat("# id T_world_scan\nc ", kQuarterTurn, "\nother ", kIdentity, "\nb ", kIdentity, "\n"));
  const auto dataset = LoadDataset(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.status();
  EXPECT_FALSE(dataset->T_world_scan[0].has_value());
  ASSERT_TRUE(dataset->T_world_scan[2].has_value());
  EXPECT_EQ(dataset->T_world_scan[2]->translation(), Eigen::Vector3d(10, 20, 30));
  ASSERT_EQ(dataset->pairs.size(), 1U) << "a has no pose, and b no scan before it with one";
  EXPECT_EQ(dataset->pairs[0].source, "c");
  EXPECT_EQ(dataset->pairs[0].target, "b");
}

TEST(DatasetTest, PrefersPairsToPoses) {
  const TemporaryFolder folder;
  AddScans(folder, {"a.pcd", "b.pcd", "c.pcd"});
  WriteBytes(folder.File("poses.txt"), absl::StrCat("a ", kIdentity, "\nb ", kIdentity, "\nc ", kIdentity, "\n"));
  WriteBytes(folder.File("pairs.txt"), absl::StrCat("a c ", kIdentity, "\n"));
  const auto dataset = LoadDataset(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.status();
  ASSERT_EQ(dataset->pairs.size(), 1U);
  EXPECT_TRUE(dataset->T_world_scan[1].has_value());
}

TEST(DatasetTest, TellsScansFromNotes) {
  const TemporaryFolder folder;
  AddScans(folder, {"a.txt", "b.txt", "README.txt", "poses_original.txt", ".hidden.txt", "log.dat"});
  std::filesystem::create_directory(folder.File("folder.txt"));
  WriteBytes(folder.File("pairs.txt"), absl::StrCat("a b ", kIdentity, "\n"));
  EXPECT_THAT(LoadDataset(folder.path())->scan_names, ElementsAre("a", "b"));
  AddScans(folder, {"c.pcd"});
  EXPECT_THAT(ErrorOf(folder), HasSubstr("no scan a")) << "text files are notes beside other scans";
}

TEST(DatasetTest, NamesFileAndLine) {
  const TemporaryFolder folder;
  AddScans(folder, {"a.pcd", "b.pcd"});
  const std::string pairs = folder.File("pairs.txt");
  for (const auto& [line, cause] : std::vector<std::pair<std::string, std::string>>{
           {absl::StrCat("a c ", kIdentity), "no scan c in the folder"},
           {"a b 1 2 3", "has 5 columns"},
           {absl::StrCat("a b much ", kIdentity), "overlap 'much'"},
           {absl::StrCat("a b 1.5 ", kIdentity), "overlap '1.5'"},
           {absl::StrCat("a b nan ", kIdentity), "overlap 'nan'"},
           {"a b 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2", "not a rigid transform"},
           {"a b 1 0 0 0 0 1 0 0 0 0 2 0 0 0 0 1", "not a rigid transform"},
           {"a b 1 0 0 inf 0 1 0 0 0 0 1 0 0 0 0 1", "'inf' is not a finite number"}}) {
    WriteBytes(pairs, absl::StrCat("# c\na b 0.5 ", kIdentity, "\n", line, "\n"));
    EXPECT_THAT(ErrorOf(folder), StartsWith(pairs + ": line 3: "));
    EXPECT_THAT(ErrorOf(folder), HasSubstr(cause));
  }
  std::filesystem::remove(pairs);
  const std::string poses = folder.File("poses.txt");
  WriteBytes(poses, absl::StrCat("a ", kIdentity, "\nb 1 2 3\n"));
  EXPECT_THAT(ErrorOf(folder), StartsWith(poses + ": line 2: "));
  WriteBytes(poses, absl::StrCat("a ", kIdentity, "\na ", kIdentity, "\n"));
  EXPECT_THAT(ErrorOf(folder), StartsWith(poses + ": line 2: second pose of scan a"));
  WriteBytes(poses, absl::StrCat("x ", kIdentity, "\n"));
  EXPECT_EQ(ErrorOf(folder), poses + ": names no scan of the folder");
  WriteBytes(poses, "0 0 0 0 0 0 0 1\n");
  EXPECT_EQ(ErrorOf(folder), poses + ": has 1 poses for 2 scans");
}

TEST(DatasetTest, RefusesFoldersThatAreNoDataSet) {
  const TemporaryFolder folder;
  EXPECT_EQ(ErrorOf(folder), folder.path() + ": contains no scans");
  AddScans(folder, {"a.pcd", "a.ply"});
  EXPECT_THAT(ErrorOf(folder), HasSubstr("another scan in the folder has this name"));
  std::filesystem::remove(folder.File("a.ply"));
  EXPECT_EQ(ErrorOf(folder), folder.path() + ": has neither pairs.txt nor poses.txt");
  const auto without_truth = LoadDataset(folder.path(), {.needs_truth = false});
  ASSERT_TRUE(without_truth.ok()) << without_truth.status();
  EXPECT_EQ(without_truth->scan_names.size(), 1U);
  EXPECT_TRUE(without_truth->pairs.empty());
  EXPECT_TRUE(absl::IsNotFound(LoadDataset(folder.File("none")).status()));
  EXPECT_TRUE(absl::IsNotFound(LoadDataset(folder.File("a.pcd")).status())) << "a file is no folder";
  EXPECT_TRUE(absl::IsInvalidArgument(LoadDataset(folder.path(), {.every = 0}).status()));
}

TEST(DatasetTest, NamesTheFolderThatMayNotBeRead) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.File("set"));
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
  std::filesystem::permissions(folder.File("set"), std::filesystem::perms(0));
  absl::Status status;
  {
    const testing::OrdinaryUser user;
    if (!user.is_ordinary()) GTEST_SKIP() << "cannot give up the rights of root";
    status = LoadDataset(folder.File("set")).status();
  }
  std::filesystem::permissions(folder.File("set"), std::filesystem::perms(0700));
  EXPECT_TRUE(absl::IsPermissionDenied(status));
  EXPECT_EQ(std::string(status.message()), folder.File("set") + ": cannot read the folder: Permission denied");
}

struct RealSet {
  const char* name;
  std::size_t num_scans;
  std::size_t num_pairs;
};

class RealDatasetTest : public ::testing::TestWithParam<RealSet> {};

TEST_P(RealDatasetTest, IsRead) {
  const auto folder = testing::RealDataPath(GetParam().name);
  if (!folder.has_value()) GTEST_SKIP() << GetParam().name << " is not on this machine";
  const auto dataset = LoadDataset(*folder);
  ASSERT_TRUE(dataset.ok()) << dataset.status();
  EXPECT_EQ(dataset->scan_names.size(), GetParam().num_scans);
  EXPECT_EQ(dataset->pairs.size(), GetParam().num_pairs);
  for (const ScanPair& pair : dataset->pairs) {
    EXPECT_TRUE(IsRigid(pair.T_target_source, 1e-12));
    EXPECT_GT(pair.overlap, 0.1);
    EXPECT_LT(pair.overlap, 1.0);
  }
}

INSTANTIATE_TEST_SUITE_P(AllSets, RealDatasetTest,
                         ::testing::Values(RealSet{"a1_hilti2021_os0_hall", 19, 171}, RealSet{"a3_3dtk_kurt3d", 3, 3},
                                           RealSet{"a4_libpointmatcher_car", 3, 3},
                                           RealSet{"a5_libpointmatcher_apartment", 2, 1}, RealSet{"b2_kitti00", 4, 6},
                                           RealSet{"b4_small_gicp_hdl32", 2, 1}, RealSet{"b7_nuscenes_kcp", 2, 1}),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

TEST(DatasetTest, PairsOfRealSetsAgreeWithTheirPoses) {
  for (const char* name : {"a1_hilti2021_os0_hall", "a4_libpointmatcher_car", "b2_kitti00", "b7_nuscenes_kcp"}) {
    const auto folder = testing::RealDataPath(name);
    if (!folder.has_value()) GTEST_SKIP() << name << " is not on this machine";
    const auto dataset = LoadDataset(*folder);
    ASSERT_TRUE(dataset.ok()) << dataset.status();
    for (const ScanPair& pair : dataset->pairs) {
      const auto pose_of = [&](const std::string& scan) {
        const auto found = std::find(dataset->scan_names.begin(), dataset->scan_names.end(), scan);
        return dataset->T_world_scan[static_cast<std::size_t>(found - dataset->scan_names.begin())].value();
      };
      const TransformDifference difference =
          Difference(pair.T_target_source, pose_of(pair.target).inverse() * pose_of(pair.source));
      EXPECT_LT(difference.rotation_rad, 1e-4) << name;
      EXPECT_LT(difference.translation_m, 1e-3) << name;
    }
  }
}

}  // namespace
}  // namespace curvereg
