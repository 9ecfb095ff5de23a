// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/scan_folder.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/test_data.h"

namespace curvereg::cli {
namespace {

using std::chrono::milliseconds;

void Write(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::app) << text; }

TEST(ScanFolderTest, AGrowingFolderGivesFilesOnceTheyHaveSettled) {
  const curvereg::testing::TemporaryFolder folder;
  Write(folder.File("1.pcd"), "complete");
  std::jthread writer([&] {
    for (int i = 0; i < 8; ++i) {  // grows for longer than it takes to settle
      Write(folder.File("2.pcd"), "x");
      std::this_thread::sleep_for(milliseconds(50));
    }
  });
  GrowingFolder growing(folder.path(), {.settle_time = milliseconds(200), .idle_end = milliseconds(700)});
  EXPECT_EQ(*growing.Next({}), folder.File("1.pcd"));
  EXPECT_EQ(*growing.Next({}), folder.File("2.pcd"));
  EXPECT_EQ(std::filesystem::file_size(folder.File("2.pcd")), 8U);
  Write(folder.File("0.pcd"), "too late");
  EXPECT_EQ(*growing.Next({}), "") << "idle";
  EXPECT_EQ(growing.num_late(), 1);
}

TEST(ScanFolderTest, AGrowingFolderEndsWhenStopped) {
  const curvereg::testing::TemporaryFolder folder;
  GrowingFolder growing(folder.path(), {});
  std::stop_source stop;
  std::jthread stopper([&] {
    std::this_thread::sleep_for(milliseconds(100));
    stop.request_stop();
  });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(*growing.Next(stop.get_token()), "");
  EXPECT_LT(std::chrono::steady_clock::now() - start, milliseconds(2000));
  EXPECT_FALSE(GrowingFolder(folder.File("nowhere"), {}).Next({}).ok());
}

}  // namespace
}  // namespace curvereg::cli
