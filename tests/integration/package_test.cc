// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a user of the library does: install, find the package from a project outside the tree, build, run.
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "core/base/rigid_transform.h"
#include "files/cloud_file.h"
#include "server/server.h"
#include "tests/testing/scenes.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

std::string ReadFile(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// Exit status of a shell command, its output in `log`.
int RunShell(const std::string& command, const std::string& log) {
  const int status = std::system((command + " >'" + log + "' 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

class PackageTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new testing::TemporaryFolder;
    const std::string cmake = "'" CURVEREG_CMAKE "' ";
    const std::string log = folder_->File("log");
    ASSERT_EQ(RunShell(cmake + "--install '" CURVEREG_BUILD_DIR "' --component development --prefix '" +
                           folder_->File("installed") + "'",
                       log),
              0)
        << ReadFile(log);
    ASSERT_EQ(RunShell(cmake + "-S '" CURVEREG_SOURCE_DIR "/examples/register_scans' -B '" + folder_->File("example") +
                           "' -D CMAKE_PREFIX_PATH='" + folder_->File("installed") + "' -D CMAKE_BUILD_TYPE=Release",
                       log),
              0)
        << ReadFile(log);
    ASSERT_EQ(RunShell(cmake + "--build '" + folder_->File("example") + "'", log), 0) << ReadFile(log);
  }
  static void TearDownTestSuite() { delete folder_; }

  static int RunExample(const std::string& arguments) {
    return RunShell(absl::StrCat("'", folder_->File("example"), "/register_scans' ", arguments), folder_->File("out"));
  }

  static inline testing::TemporaryFolder* folder_ = nullptr;
};

TEST_F(PackageTest, TheExampleRegistersTwoFilesThroughAServer) {
  server::ServerConfig config;
  config.listen = "127.0.0.1:0";
  config.ops_listen = "";
  config.data_dir = folder_->File("data");
  const auto server = server::Server::Start(config);
  ASSERT_TRUE(server.ok()) << server.status();
  const RigidTransform T_world_source = testing::RoverPose(1.0, 0.5, 0.3);
  const RigidTransform T_world_target = testing::RoverPose(0, 0, 0);
  ASSERT_TRUE(WriteCloudFile(folder_->File("source.pcd"), testing::BumpyGround(T_world_source)).ok());
  ASSERT_TRUE(WriteCloudFile(folder_->File("target.pcd"), testing::BumpyGround(T_world_target)).ok());
  const std::string files = " '" + folder_->File("source.pcd") + "' '" + folder_->File("target.pcd") + "'";
  ASSERT_EQ(RunExample("127.0.0.1:" + std::to_string((*server)->port()) + files), 0) << ReadFile(folder_->File("out"));

  std::istringstream out(ReadFile(folder_->File("out")));
  Eigen::Vector3d t;
  Eigen::Quaterniond q;
  ASSERT_TRUE(out >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w());
  const RigidTransform truth = T_world_target.inverse() * T_world_source;
  EXPECT_LT((t - truth.translation()).norm(), 0.05);
  EXPECT_LT(q.angularDistance(Eigen::Quaterniond(truth.rotation())), 0.01);
}

TEST_F(PackageTest, TheExampleTellsWhatIsWrong) {
  EXPECT_EQ(RunExample(""), 2);
  EXPECT_EQ(RunExample("127.0.0.1:1 none.pcd none.pcd"), 1);
  EXPECT_THAT(ReadFile(folder_->File("out")), ::testing::HasSubstr("none.pcd"));
}

}  // namespace
}  // namespace curvereg
