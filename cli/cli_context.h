// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What all commands share: exit status, where messages go, interruption, output paths.
//
// Rules: a result goes to standard output, everything else to standard error. With --json standard output holds exactly
// one JSON object, or nothing when the command failed.
#ifndef CURVEREG_CLI_CLI_CONTEXT_H_
#define CURVEREG_CLI_CLI_CONTEXT_H_

#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "core/base/stop.h"
#include "program/command_syntax.h"

namespace curvereg::cli {

enum class ExitCode : int {
  kDone = 0,         // done, and accepted where there is a verdict
  kInternal = 1,     // a fault of ours, or interrupted
  kUsage = 2,        // wrong arguments, unusable input, output that cannot be written
  kRejected = 3,     // done, but the registration is rejected
  kUnreachable = 4,  // server unreachable or it refused
};

struct CliContext {
  std::stop_token interrupted;  // requested at the first SIGINT or SIGTERM
  Stop UntilInterrupted() const { return {interrupted, std::nullopt}; }
};

// One command: `Add...Command(app)` declares its arguments and returns what runs it once they are parsed.
using CommandRunner = std::function<ExitCode(const CliContext&)>;
struct Command {
  CommandSyntax syntax;  // knows whether the command was given
  CommandRunner run;
};

ExitCode ExitCodeFor(const absl::Status& status);

// Prints "curvereg: <message>" and, after a semicolon, what there is of `advice` to standard error. Returns
// ExitCodeFor(status). Precondition: !status.ok().
ExitCode ReportError(const absl::Status& status, const std::string& advice = "");

// Prints "curvereg: warning: <message>" to standard error.
void ReportWarning(const std::string& message);

// Prints `text` to standard output and flushes. INTERNAL code of ReportError when it cannot be written (a closed pipe).
ExitCode PrintResult(const std::string& text);

// Creates the folder (and its parents) unless it is there. INVALID_ARGUMENT naming the path and the cause: it is a
// file, a parent is one, no permission, nothing can be written into it.
absl::Status PrepareOutputFolder(const std::string& path);

// Checked before long work: the folder that is to hold `path` exists and `path` itself is not a folder.
absl::Status CheckOutputFile(const std::string& path);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_CLI_CONTEXT_H_
