// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The program curvereg-server as its users see it: settings, ports, signals, exit status.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <vector>

#include "grpc/health/v1/health.grpc.pb.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::HasSubstr;

std::string ReadAll(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class ServerProgramTest : public ::testing::Test {
 protected:
  ~ServerProgramTest() override {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      Wait();
    }
  }

  // Runs the program in the test's folder, stdout to the file "out", stderr to "err".
  void Start(const std::vector<std::string>& arguments) {
    pid_ = fork();
    ASSERT_GE(pid_, 0);
    if (pid_ > 0) return;
    const bool is_ready = chdir(folder_.path().c_str()) == 0 && freopen("out", "w", stdout) != nullptr &&
                          freopen("err", "w", stderr) != nullptr;
    std::vector<char*> argv = {const_cast<char*>("curvereg-server")};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    if (is_ready) execv(CURVEREG_SERVER_EXECUTABLE, argv.data());
    _exit(127);
  }
  // The exit status, or minus the signal that ended the program.
  int Wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  int Run(const std::vector<std::string>& arguments) {
    Start(arguments);
    return Wait();
  }
  // Starts to serve on free ports; the ports.
  nlohmann::json Serve(std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.end(), {"--listen", "127.0.0.1:0", "--ops-listen", "127.0.0.1:0", "--ports-file",
                                       "ports.json", "--data-dir", "data", "--log-format", "json"});
    Start(arguments);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!std::filesystem::exists(folder_.File("ports.json")) && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return nlohmann::json::parse(ReadAll(folder_.File("ports.json")), nullptr, /*allow_exceptions=*/false);
  }
  std::string Out() const { return ReadAll(folder_.File("out")); }
  std::string Err() const { return ReadAll(folder_.File("err")); }

  const testing::TemporaryFolder folder_;
  pid_t pid_ = -1;
};

grpc::Status CheckHealth(int port) {
  const auto channel = grpc::CreateChannel("127.0.0.1:" + std::to_string(port), grpc::InsecureChannelCredentials());
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
  grpc::health::v1::HealthCheckResponse response;
  return grpc::health::v1::Health::NewStub(channel)->Check(&context, {}, &response);
}

TEST_F(ServerProgramTest, ServesUntilItIsAskedToStop) {
  const nlohmann::json ports = Serve({"--drain-delay-ms", "0"});
  ASSERT_TRUE(ports.is_object()) << Err();
  EXPECT_GT(ports["ops_port"].get<int>(), 0);
  EXPECT_TRUE(CheckHealth(ports["grpc_port"].get<int>()).ok());
  kill(pid_, SIGTERM);
  EXPECT_EQ(Wait(), 0);
  std::vector<std::string> events;
  std::istringstream lines(Err());
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json event = nlohmann::json::parse(line, nullptr, /*allow_exceptions=*/false);
    ASSERT_TRUE(event.is_object()) << line;
    events.push_back(event["event"]);
    if (events.back() == "listening") {
      EXPECT_EQ(event["grpc_port"], ports["grpc_port"]);
    }
  }
  EXPECT_THAT(events, ::testing::IsSupersetOf({"listening", "stopping", "stopped"}));
}

TEST_F(ServerProgramTest, CtrlCIsAnOrderlyStopToo) {
  ASSERT_TRUE(Serve({"--drain-delay-ms", "0"}).is_object()) << Err();
  kill(pid_, SIGINT);
  EXPECT_EQ(Wait(), 0);
}

TEST_F(ServerProgramTest, AskedTwiceItLeavesAtOnce) {
  ASSERT_TRUE(Serve({"--drain-delay-ms", "20000"}).is_object()) << Err();
  const auto begin = std::chrono::steady_clock::now();
  kill(pid_, SIGTERM);
  std::this_thread::sleep_for(std::chrono::milliseconds(800));
  kill(pid_, SIGTERM);
  EXPECT_EQ(Wait(), 1);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST_F(ServerProgramTest, APortInUseIsAFailureAndNamed) {
  const nlohmann::json ports = Serve({"--drain-delay-ms", "0"});
  ASSERT_TRUE(ports.is_object()) << Err();
  const pid_t first = pid_;
  const std::string address = "127.0.0.1:" + std::to_string(ports["grpc_port"].get<int>());
  EXPECT_EQ(Run({"--listen", address, "--ops-listen", "", "--data-dir", "other"}), 1);
  EXPECT_THAT(Err(), HasSubstr(address));
  pid_ = first;
}

TEST_F(ServerProgramTest, WrongSettingsAreUsageErrors) {
  EXPECT_EQ(Run({"--nonsense"}), 2);
  EXPECT_EQ(Run({"--limits-max-uploads", "many"}), 2);
  EXPECT_THAT(Err(), HasSubstr("--limits-max-uploads"));
  EXPECT_EQ(Run({"--listen", "0.0.0.0:0"}), 2);
  std::ofstream(folder_.File("server.toml")) << "listen = 'localhost:0'\nlisten_on = 1\n";
  EXPECT_EQ(Run({"--config", "server.toml"}), 2);
  EXPECT_THAT(Err(), HasSubstr("server.toml:2: "));
  EXPECT_EQ(Run({"--config", "no-such-file.toml"}), 2);
  EXPECT_THAT(Err(), HasSubstr("--config: no-such-file.toml"));
}

TEST_F(ServerProgramTest, AnEmptyValueIsNotTheNextArgument) {
  ASSERT_EQ(Run({"--ops-listen=", "--token-file=", "--print-config"}), 0) << Err();
  EXPECT_THAT(Out(), HasSubstr("\nops_listen = \"\""));
  EXPECT_EQ(Run({"--data-dir=", "--token-file=tokens.toml", "--print-config"}), 2);
  EXPECT_THAT(Err(), HasSubstr("data_dir: must not be empty"));
  EXPECT_EQ(Run({"--limits-max-uploads=", "--print-config"}), 2);
  EXPECT_THAT(Err(), HasSubstr("--limits-max-uploads: expected a whole number"));
  for (const char* flag : {"--allow-plaintext", "--config", "--ports-file"}) {
    EXPECT_EQ(Run({std::string(flag) + "=", "--print-config"}), 2) << flag;
    EXPECT_THAT(Err(), HasSubstr(flag));
  }
  EXPECT_EQ(Run({"make-token", "--append-to=", "rover"}), 2);
  EXPECT_THAT(Err(), HasSubstr("--append-to: must not be empty"));
}

TEST_F(ServerProgramTest, FilesThatAreNotThereAreWrongSettings) {
  const std::vector<std::string> basics = {"--listen", "127.0.0.1:0", "--ops-listen=", "--data-dir=data"};
  auto arguments = basics;
  arguments.insert(arguments.end(), {"--token-file", "none.toml"});
  EXPECT_EQ(Run(arguments), 2);
  EXPECT_THAT(Err(), HasSubstr("token_file: none.toml"));
  arguments = basics;
  arguments.insert(arguments.end(), {"--tls-certificate-file", "none.pem", "--tls-key-file", "none.key"});
  EXPECT_EQ(Run(arguments), 2);
  EXPECT_THAT(Err(), HasSubstr("tls.certificate_file: none.pem"));
}

TEST_F(ServerProgramTest, PrintsItsSettingsAsAFileItReads) {
  ASSERT_EQ(Run({"--limits-memory-bytes", "3GiB", "--allow-plaintext", "--print-config"}), 0) << Err();
  const std::string printed = Out();
  EXPECT_THAT(printed, HasSubstr("memory_bytes = \"3GiB\""));
  EXPECT_THAT(printed, HasSubstr("allow_plaintext = true"));
  std::ofstream(folder_.File("server.toml")) << printed;
  ASSERT_EQ(Run({"--config", "server.toml", "--print-config"}), 0) << Err();
  EXPECT_EQ(Out(), printed);
}

TEST_F(ServerProgramTest, MakesTokensThatItReads) {
  ASSERT_EQ(Run({"make-token", "rover", "--scope", "write", "--append-to", "tokens.toml"}), 0) << Err();
  ASSERT_EQ(Run({"make-token", "ground", "--append-to", "tokens.toml"}), 0) << Err();
  EXPECT_EQ(Out().size(), 4 + 64 + 1u);  // the token and nothing else
  EXPECT_EQ(Run({"make-token", "two words", "--append-to", "tokens.toml"}), 2);
  std::ofstream(folder_.File("settings.toml")) << "listen = 'localhost:0'\n";
  EXPECT_EQ(Run({"make-token", "rover", "--append-to", "settings.toml"}), 2);
  EXPECT_THAT(Err(), HasSubstr("settings.toml:1: "));
  EXPECT_EQ(ReadAll(folder_.File("settings.toml")), "listen = 'localhost:0'\n");
  ASSERT_TRUE(Serve({"--drain-delay-ms", "0", "--token-file", "tokens.toml"}).is_object()) << Err();
  EXPECT_THAT(Err(), HasSubstr("\"tokens\":2"));
}

TEST_F(ServerProgramTest, TellsItsVersion) {
  EXPECT_EQ(Run({"--version"}), 0);
  EXPECT_THAT(Out(), ::testing::StartsWith("curvereg "));
}

}  // namespace
}  // namespace curvereg
