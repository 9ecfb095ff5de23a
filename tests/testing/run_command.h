// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Commands run as a user runs them.
#ifndef CURVEREG_TESTS_TESTING_RUN_COMMAND_H_
#define CURVEREG_TESTS_TESTING_RUN_COMMAND_H_

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace curvereg::testing {

struct Finished {
  int status = -1;  // -1: ended by a signal
  std::string out;
  std::string err;
};

// Empty when there is no such file.
inline std::string ReadFile(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// Runs the shell's command line in the folder, which gets the hidden files .out and .err.
inline Finished RunIn(const std::string& folder, const std::string& command) {
  const int status = std::system(("cd '" + folder + "' && " + command + " >.out 2>.err").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadFile(folder + "/.out"), ReadFile(folder + "/.err")};
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_RUN_COMMAND_H_
