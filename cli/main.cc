// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// curvereg: the command line. One file per command; what they share is in cli_context.h.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "cli/cli_context.h"
#include "cli/evaluate_command.h"
#include "cli/inspect_command.h"
#include "cli/map_command.h"
#include "cli/register_command.h"
#include "cli/scans_command.h"
#include "cli/simulate_command.h"
#include "cli/status_command.h"
#include "cli/stream_command.h"
#include "cli/trajectory_command.h"
#include "cli/traverse_command.h"
#include "cli/watch_command.h"
#include "program/command_syntax.h"
#include "program/heap_tuning.h"
#include "program/program_arguments.h"
#include "program/termination_signals.h"

namespace curvereg::cli {
namespace {

// CLI11 says only "A subcommand is required" when the first word is none.
ExitCode ReportUsage(const CLI::App& app, const CLI::ParseError& error, const std::string& first_word) {
  const auto named = app.get_subcommands([&](const CLI::App* command) { return command->get_name() == first_word; });
  const bool is_unknown = !first_word.empty() && first_word[0] != '-' && named.empty();
  if (!is_unknown) return app.exit(error) == 0 ? ExitCode::kDone : ExitCode::kUsage;  // prints help, version or error
  return ReportError(absl::InvalidArgumentError("unknown command '" + first_word + "'; see curvereg --help"));
}

// Mostly from an unset variable of a script. Only --server gives an empty value a meaning.
void RefuseEmptyValues(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const bool takes_value = option->get_items_expected_max() > 0;
    if (takes_value && option->get_name() != "--server") option->check(CheckNotEmpty);
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) RefuseEmptyValues(*command);
}

ExitCode ParseAndRun(int argc, char** argv) {
  CLI::App app("Registration of 3-D laser scans of planetary terrain", "curvereg");
  app.set_version_flag("--version", "curvereg " CURVEREG_VERSION);
  CommandSyntax syntax(app);
  syntax.RequireCommand();
  const std::vector<Command> commands = {
      AddRegisterCommand(syntax),   AddSimulateCommand(syntax), AddEvaluateCommand(syntax), AddInspectCommand(syntax),
      AddScansCommand(syntax),      AddStatusCommand(syntax),   AddStreamCommand(syntax),   AddWatchCommand(syntax),
      AddTrajectoryCommand(syntax), AddMapCommand(syntax),      AddTraverseCommand(syntax)};
  RefuseEmptyValues(app);
  try {
    ParseArguments(app, argc, argv);
  } catch (const CLI::ParseError& error) {
    return ReportUsage(app, error, argc > 1 ? argv[1] : "");
  }
  setenv("GRPC_VERBOSITY", "NONE", 0);  // its many lines repeat our one error message
  KeepFreedMemory();                    // the service runs in this process unless --server is given
  const TerminationSignals signals("curvereg: interrupted again, leaving at once\n");
  for (const Command& command : commands) {
    if (command.syntax.WasNamed()) return command.run({.interrupted = signals.token()});
  }
  return ExitCode::kUsage;  // unreachable: a subcommand is required
}

// Our code throws nothing; the libraries below it may, above all when memory runs out.
ExitCode Main(int argc, char** argv) {
  try {
    return ParseAndRun(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("curvereg: out of memory\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "curvereg: internal error: %s\n", error.what());
  }
  return ExitCode::kInternal;
}

}  // namespace
}  // namespace curvereg::cli

int main(int argc, char** argv) { return static_cast<int>(curvereg::cli::Main(argc, argv)); }
