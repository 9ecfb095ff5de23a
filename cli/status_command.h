// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// curvereg status: whether a server serves, what it can do, and its limits.
#ifndef CURVEREG_CLI_STATUS_COMMAND_H_
#define CURVEREG_CLI_STATUS_COMMAND_H_

#include "cli/cli_context.h"
#include "program/command_syntax.h"

namespace curvereg::cli {

Command AddStatusCommand(CommandSyntax app);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_STATUS_COMMAND_H_
