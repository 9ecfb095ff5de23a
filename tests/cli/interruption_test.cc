// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One ^C ends every command that waits for a server.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <chrono>
#include <fstream>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/cli_context.h"
#include "cli/scans_command.h"
#include "cli/status_command.h"
#include "cli/stream_command.h"
#include "cli/trajectory_command.h"
#include "cli/traverse_command.h"
#include "tests/testing/silent_server.h"
#include "tests/testing/test_data.h"

namespace curvereg::cli {
namespace {

using Clock = std::chrono::steady_clock;

ExitCode RunInterrupted(const std::string& command_line) {
  CLI::App app;
  const CommandSyntax syntax(app);
  const std::vector<Command> commands = {AddScansCommand(syntax), AddStatusCommand(syntax), AddStreamCommand(syntax),
                                         AddTrajectoryCommand(syntax), AddTraverseCommand(syntax)};
  app.parse(command_line);
  std::stop_source interrupted;
  const std::jthread user([&interrupted] {
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    interrupted.request_stop();
  });
  for (const Command& command : commands) {
    if (command.syntax.WasNamed()) return command.run({.interrupted = interrupted.get_token()});
  }
  return ExitCode::kUsage;
}

void ExpectEndsSoon(const std::string& command_line) {
  const Clock::time_point start = Clock::now();
  EXPECT_EQ(RunInterrupted(command_line), ExitCode::kInternal) << command_line;
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(5)) << command_line;
}

TEST(Interruption, EndsCallsThatAreNotAnswered) {
  const testing::SilentServer server;
  const testing::TemporaryFolder folder;
  std::ofstream(folder.File("scan.xyz")) << "1 2 3\n";
  const std::string stream = "stream " + folder.path() + " --traverse drive";
  for (const std::string& command :
       {std::string("status"), std::string("scans list"), std::string("scans delete scans/1"),
        std::string("traverse list"), std::string("traverse show drive"), std::string("traverse delete drive"),
        std::string("trajectory drive"), stream, stream + " --resume"}) {
    ExpectEndsSoon(command + " --timeout 30 --server " + server.target());
  }
}

TEST(Interruption, EndsTheWaitForAServer) {
  ExpectEndsSoon("status --timeout 30 --server 127.0.0.1:1");
  ExpectEndsSoon("traverse list --timeout 30 --server 127.0.0.1:1");
}

}  // namespace
}  // namespace curvereg::cli
