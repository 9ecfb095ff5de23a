// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a user of the library does: install, find the package from a project outside the tree, build, run.
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
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

std::vector<std::string> FileNames(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  return names;
}

// As on a machine without them: finding them fails.
constexpr char kWithoutGrpc[] = "-D CMAKE_DISABLE_FIND_PACKAGE_gRPC=ON -D CMAKE_DISABLE_FIND_PACKAGE_Protobuf=ON";

class PackageTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new testing::TemporaryFolder;
    ASSERT_EQ(
        RunShell(kCMake + "--install '" CURVEREG_BUILD_DIR "' --component development --prefix " + Quoted("installed"),
                 Log()),
        0)
        << ReadFile(Log());
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string Log() { return folder_->File("log"); }
  static std::string Quoted(const std::string& name) { return absl::StrCat("'", folder_->File(name), "'"); }

  // Configures the project in `source` against the installed package; exit status.
  static int Configure(const std::string& source, const std::string& build, const std::string& options = "") {
    return RunShell(absl::StrCat(kCMake, "-S '", source, "' -B ", Quoted(build), " -D CMAKE_PREFIX_PATH=",
                                 Quoted("installed"), " -D CMAKE_BUILD_TYPE=Release ", options),
                    Log());
  }
  static int Build(const std::string& build) {
    return RunShell(absl::StrCat(kCMake, "--build ", Quoted(build)), Log());
  }
  static void BuildExample(const std::string& name, const std::string& options = "") {
    ASSERT_EQ(Configure(CURVEREG_SOURCE_DIR "/examples/" + name, name, options), 0) << ReadFile(Log());
    ASSERT_EQ(Build(name), 0) << ReadFile(Log());
  }
  static int RunExample(const std::string& name, const std::string& arguments) {
    return RunShell(absl::StrCat(Quoted(name + "/" + name), " ", arguments), folder_->File("out"));
  }

  // A project of one file and the CMake lines that it is built with.
  static std::string WriteProject(const std::string& name, const std::string& cmake_lines, const std::string& source) {
    const std::string folder = folder_->File(name);
    std::filesystem::create_directory(folder);
    std::ofstream(folder + "/main.cc") << source;
    std::ofstream(folder + "/CMakeLists.txt") << "cmake_minimum_required(VERSION 3.25)\nproject(user LANGUAGES C CXX)\n"
                                              << cmake_lines;
    return folder;
  }

  // Writes source.pcd and target.pcd, two views of one place; returns their names as arguments.
  static std::string WriteScans(const RigidTransform& T_world_source, const RigidTransform& T_world_target) {
    EXPECT_TRUE(WriteCloudFile(folder_->File("source.pcd"), testing::BumpyGround(T_world_source)).ok());
    EXPECT_TRUE(WriteCloudFile(folder_->File("target.pcd"), testing::BumpyGround(T_world_target)).ok());
    return absl::StrCat(Quoted("source.pcd"), " ", Quoted("target.pcd"));
  }

  // The pose that an example printed is `truth`.
  static void ExpectPrinted(const RigidTransform& truth) {
    std::istringstream out(ReadFile(folder_->File("out")));
    Eigen::Vector3d t;
    Eigen::Quaterniond q;
    ASSERT_TRUE(out >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w());
    EXPECT_LT((t - truth.translation()).norm(), 0.05);
    EXPECT_LT(q.angularDistance(Eigen::Quaterniond(truth.rotation())), 0.01);
  }

  static inline const std::string kCMake = "'" CURVEREG_CMAKE "' ";
  static inline testing::TemporaryFolder* folder_ = nullptr;
};

TEST_F(PackageTest, TheExampleRegistersTwoFilesThroughAServer) {
  BuildExample("register_scans");
  server::ServerConfig config;
  config.listen = "127.0.0.1:0";
  config.ops_listen = "";
  config.data_dir = folder_->File("data");
  const auto server = server::Server::Start(config);
  ASSERT_TRUE(server.ok()) << server.status();
  const RigidTransform T_world_source = testing::RoverPose(1.0, 0.5, 0.3);
  const RigidTransform T_world_target = testing::RoverPose(0, 0, 0);
  const std::string files = WriteScans(T_world_source, T_world_target);
  ASSERT_EQ(RunExample("register_scans", absl::StrCat("127.0.0.1:", (*server)->port(), " ", files)), 0)
      << ReadFile(folder_->File("out"));
  ExpectPrinted(T_world_target.inverse() * T_world_source);

  // What is wrong with the call.
  EXPECT_EQ(RunExample("register_scans", ""), 2);
  EXPECT_EQ(RunExample("register_scans", "127.0.0.1:1 none.pcd none.pcd"), 1);
  EXPECT_THAT(ReadFile(folder_->File("out")), ::testing::HasSubstr("none.pcd"));
}

TEST_F(PackageTest, ThePclExampleRegistersTwoFilesWithoutGrpc) {
  if (!CURVEREG_HAS_PCL) GTEST_SKIP() << "this build has no PCL (CURVEREG_BUILD_BASELINES=OFF)";
  BuildExample("pcl_registration", kWithoutGrpc);
  const RigidTransform T_world_source = testing::RoverPose(1.0, 0.5, 0.3);
  const RigidTransform T_world_target = testing::RoverPose(0, 0, 0);
  const std::string files = WriteScans(T_world_source, T_world_target);
  ASSERT_EQ(RunExample("pcl_registration", files), 0) << ReadFile(folder_->File("out"));
  ExpectPrinted(T_world_target.inverse() * T_world_source);
  EXPECT_THAT(ReadFile(folder_->File("out")), ::testing::HasSubstr("fitness score: "));

  // Another place is rejected.
  ASSERT_TRUE(WriteCloudFile(folder_->File("other.pcd"), testing::BumpyGround(T_world_target, {.world_seed = 7})).ok());
  EXPECT_EQ(RunExample("pcl_registration", absl::StrCat(Quoted("source.pcd"), " ", Quoted("other.pcd"))), 3);
  EXPECT_THAT(ReadFile(folder_->File("out")), ::testing::StartsWith("rejected: "));

  // What is wrong with the call.
  EXPECT_EQ(RunExample("pcl_registration", ""), 2);
  EXPECT_EQ(RunExample("pcl_registration", "none.pcd none.pcd"), 1);
  EXPECT_THAT(ReadFile(folder_->File("out")), ::testing::HasSubstr("none.pcd"));
}

// Every installed header compiles with the one search path PREFIX/include, and all of them lie below curvereg/. Those
// of the wire need google/rpc besides, which curvereg::wire brings.
TEST_F(PackageTest, EveryHeaderIsFoundBelowOnePrefix) {
  const std::filesystem::path include = folder_->File("installed/include");
  EXPECT_THAT(FileNames(include), ::testing::ElementsAre("curvereg"));
  std::string source;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(include)) {
    const std::string name = entry.path().lexically_relative(include);
    const bool needs_pcl = name.starts_with("curvereg/pcl");
    if (entry.is_regular_file() && !name.starts_with("curvereg/proto/") && !needs_pcl) {
      absl::StrAppend(&source, "#include <", name, ">\n");
    }
  }
  for (const char* name : {"client.h", "traverses.h", "core/register_scans.h", "files/cloud_file.h", "render/png.h",
                           "wire/error.h", "v1/registration.pb.h"}) {
    EXPECT_THAT(source, ::testing::HasSubstr(absl::StrCat("#include <curvereg/", name, ">\n")));
  }
  absl::StrAppend(&source, "int main() { return curvereg::BuildId().empty() ? 1 : 0; }\n");
  const std::string project =
      WriteProject("headers",
                   "find_package(curvereg REQUIRED)\n"
                   "add_executable(user main.cc)\n"
                   "target_link_libraries(user PRIVATE curvereg::wire curvereg::client curvereg::files)\n",
                   source);
  ASSERT_EQ(Configure(project, "headers_build"), 0) << ReadFile(Log());
  EXPECT_EQ(Build("headers_build"), 0) << ReadFile(Log());
}

TEST_F(PackageTest, AComponentAsksOnlyForWhatItNeeds) {
  const auto find = [&](const std::string& components) {
    const std::string project =
        WriteProject("find", absl::StrCat("find_package(curvereg REQUIRED ", components, ")\n"), "");
    std::filesystem::remove_all(folder_->File("find_build"));
    return Configure(project, "find_build", kWithoutGrpc);
  };
  EXPECT_EQ(find("COMPONENTS core"), 0) << ReadFile(Log());
  EXPECT_EQ(find("COMPONENTS core render files"), 0) << ReadFile(Log());
  EXPECT_NE(find("COMPONENTS client"), 0);
  EXPECT_NE(find(""), 0);
  EXPECT_THAT(ReadFile(Log()), ::testing::HasSubstr("Protobuf"));
  EXPECT_NE(find("COMPONENTS core nonsense"), 0);
  EXPECT_THAT(ReadFile(Log()), ::testing::HasSubstr("nonsense"));
}

TEST_F(PackageTest, InstallingFailsWhenAHeaderWouldMissAnother) {
  const std::string stage =
      absl::StrCat(kCMake, "-D source_dir='" CURVEREG_SOURCE_DIR "' -D output_dir=", Quoted("staged"),
                   " -D generated_dir=none -D 'headers=core/scan/scan.h",
                   "%s' -P '" CURVEREG_SOURCE_DIR "/cmake/InstallHeaders.cmake'");
  EXPECT_NE(RunShell(absl::StrReplaceAll(stage, {{"%s", ""}}), Log()), 0);
  EXPECT_THAT(ReadFile(Log()), ::testing::HasSubstr("core/scan/scan.h includes \"curvereg/core/base/stop.h\""));
  EXPECT_EQ(RunShell(absl::StrReplaceAll(stage, {{"%s", ";core/base/stop.h"}}), Log()), 0) << ReadFile(Log());
  EXPECT_THAT(ReadFile(folder_->File("staged/curvereg/core/scan/scan.h")),
              ::testing::HasSubstr("#include \"curvereg/core/base/stop.h\"\n"));
}

}  // namespace
}  // namespace curvereg
