// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// curvereg stream DIR --traverse ID: sends a folder of scans as a rover would.
#ifndef CURVEREG_CLI_STREAM_COMMAND_H_
#define CURVEREG_CLI_STREAM_COMMAND_H_

#include "cli/cli_context.h"
#include "program/command_syntax.h"

namespace curvereg::cli {

Command AddStreamCommand(CommandSyntax app);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_STREAM_COMMAND_H_
