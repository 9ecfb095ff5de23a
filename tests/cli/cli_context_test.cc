// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/cli_context.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/progress_bar.h"
#include "tests/testing/test_data.h"

namespace curvereg::cli {
namespace {

using ::testing::HasSubstr;

TEST(ExitCode, BadInputIsTwoAndOurFaultsAreOne) {
  EXPECT_EQ(ExitCodeFor(absl::OkStatus()), ExitCode::kDone);
  EXPECT_EQ(ExitCodeFor(absl::NotFoundError("")), ExitCode::kUsage);
  EXPECT_EQ(ExitCodeFor(absl::DataLossError("")), ExitCode::kUsage);
  EXPECT_EQ(ExitCodeFor(absl::ResourceExhaustedError("disk full")), ExitCode::kUsage);
  EXPECT_EQ(ExitCodeFor(absl::InternalError("")), ExitCode::kInternal);
  EXPECT_EQ(ExitCodeFor(absl::CancelledError("")), ExitCode::kInternal);
  EXPECT_EQ(ExitCodeFor(absl::UnavailableError("")), ExitCode::kUnreachable);
}

TEST(PrepareOutputFolder, CreatesParentsAndKeepsWhatIsThere) {
  const testing::TemporaryFolder folder;
  EXPECT_TRUE(PrepareOutputFolder(folder.File("a/b/c")).ok());
  EXPECT_TRUE(std::filesystem::is_directory(folder.File("a/b/c")));
  std::ofstream(folder.File("a/b/c/kept")) << "x";
  EXPECT_TRUE(PrepareOutputFolder(folder.File("a/b/c/")).ok());
  EXPECT_TRUE(std::filesystem::exists(folder.File("a/b/c/kept")));
}

TEST(PrepareOutputFolder, NeverReplacesAFile) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder.File("file")) << "precious";
  for (const char* name : {"file", "file/below"}) {
    const absl::Status status = PrepareOutputFolder(folder.File(name));
    EXPECT_EQ(ExitCodeFor(status), ExitCode::kUsage) << name;
    EXPECT_THAT(std::string(status.message()), HasSubstr(folder.File(name)));
  }
  EXPECT_TRUE(std::filesystem::is_regular_file(folder.File("file")));
  EXPECT_FALSE(PrepareOutputFolder("").ok());
}

TEST(CheckOutputFile, NeedsAFolderToPutItIn) {
  const testing::TemporaryFolder folder;
  EXPECT_TRUE(CheckOutputFile(folder.File("new.ply")).ok());
  EXPECT_THAT(std::string(CheckOutputFile(folder.File("no/new.ply")).message()), HasSubstr("folder does not exist"));
  EXPECT_FALSE(CheckOutputFile(folder.path()).ok());
  EXPECT_FALSE(CheckOutputFile("").ok());
}

TEST(ProgressLine, ClampsTheShare) {
  EXPECT_THAT(ProgressLine("reading", 0.5, "a.pcd"), HasSubstr("reading [###############               ]  50 % a.pcd"));
  EXPECT_THAT(ProgressLine("x", 7.0, ""), HasSubstr("100 %"));
  EXPECT_THAT(ProgressLine("x", -1.0, ""), HasSubstr("  0 %"));
  EXPECT_THAT(ProgressLine("x", std::nan(""), ""), HasSubstr("  0 %"));
}

}  // namespace
}  // namespace curvereg::cli
