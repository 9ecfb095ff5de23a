// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The built command line beside the built server. For tests with CURVEREG_EXECUTABLE and CURVEREG_SERVER_EXECUTABLE.
#ifndef CURVEREG_TESTS_TESTING_COMMAND_LINE_TEST_H_
#define CURVEREG_TESTS_TESTING_COMMAND_LINE_TEST_H_

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/testing/run_command.h"
#include "tests/testing/server_process.h"
#include "tests/testing/test_data.h"

namespace curvereg::testing {

// A folder and a server for all tests of a suite, whose SetUpTestSuite calls Start.
class CommandLineTest : public ::testing::Test {
 protected:
  static void Start(const std::vector<std::string>& server_arguments) {
    folder_ = new TemporaryFolder;
    server_ = new ServerProcess(CURVEREG_SERVER_EXECUTABLE, folder_->path(), server_arguments);
    ASSERT_NE(server_->port(), 0);
  }
  static void TearDownTestSuite() {
    delete server_;
    delete folder_;
  }
  // Runs `curvereg ARGUMENTS` in the folder, with `prefix` before it: variables, or timeout(1).
  static Finished Alone(const std::string& arguments, const std::string& prefix = "") {
    return RunIn(folder_->path(), prefix + " '" CURVEREG_EXECUTABLE "' " + arguments);
  }
  static Finished Asking(const std::string& arguments) { return Alone(arguments + " --server " + server_->target()); }
  static std::string File(const std::string& name) { return folder_->File(name); }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline ServerProcess* server_ = nullptr;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_COMMAND_LINE_TEST_H_
