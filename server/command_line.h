// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The command line of curvereg-server.
#ifndef CURVEREG_SERVER_COMMAND_LINE_H_
#define CURVEREG_SERVER_COMMAND_LINE_H_

#include <string>
#include <variant>
#include <vector>

#include "server/access/access.h"
#include "server/settings/config_sources.h"

namespace curvereg::server {

// Serve, or print something and leave.
struct ServeCommand {
  bool print_config = false;    // what is in force, as TOML, instead of serving
  bool print_settings = false;  // docs/settings.md, instead of serving
  std::string config_file;      // empty: as the environment says
  std::string ports_file;       // JSON of the bound ports, written when they are; empty: none
  std::vector<FlagValue> flags;
};

// Make a token: the token to stdout, its table for the token file to stdout or to `file`.
struct MakeTokenCommand {
  std::string name;
  Scope scope = Scope::kRead;
  std::string append_to;  // token file; empty: stdout
};

struct ParsedCommandLine {
  std::variant<ServeCommand, MakeTokenCommand> command;
  bool is_done = false;  // help, version or an error was printed: leave with this status
  int exit_status = 0;
};

// Prints help and version to stdout, errors to stderr (exit status 2).
ParsedCommandLine ParseCommandLine(int argc, const char* const* argv);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_COMMAND_LINE_H_
