// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/scan_files.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

void Touch(const std::string& path) { std::ofstream(path) << "x"; }

TEST(ScanFilesTest, GivesScansInNameOrderWithoutNotes) {
  const testing::TemporaryFolder folder;
  std::filesystem::create_directory(folder.File("folder.pcd"));
  for (const char* name : {"b-1.pcd", "b.pcd", "a.ply", "poses.txt", "README.txt", "License.txt", "odometry.txt",
                           "wheels.txt", ".hidden.pcd", "c.jpg"}) {
    Touch(folder.File(name));
  }
  const auto files = ScanFilesIn(folder.path());
  ASSERT_TRUE(files.ok()) << files.status();
  EXPECT_THAT(*files, ElementsAre(folder.File("a.ply"), folder.File("b.pcd"), folder.File("b-1.pcd")));
}

TEST(ScanFilesTest, TextFilesAreScansWhereThereAreNoOthers) {
  const testing::TemporaryFolder folder;
  for (const char* name : {"2.txt", "1.TXT", "poses.txt", "wheels.txt"}) Touch(folder.File(name));
  const auto files = ScanFilesIn(folder.path(), folder.path() + "/./wheels.txt");
  ASSERT_TRUE(files.ok()) << files.status();
  EXPECT_THAT(*files, ElementsAre(folder.File("1.TXT"), folder.File("2.txt")));
}

TEST(ScanFilesTest, SaysWhatIsNoFolder) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT(*ScanFilesIn(folder.path()), IsEmpty());
  EXPECT_TRUE(absl::IsNotFound(ScanFilesIn(folder.File("nowhere")).status()));
  Touch(folder.File("a.pcd"));
  EXPECT_FALSE(ScanFilesIn(folder.File("a.pcd")).ok());
}

}  // namespace
}  // namespace curvereg
