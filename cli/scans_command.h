// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// curvereg scans upload|list|download|delete: the scans that a server keeps.
#ifndef CURVEREG_CLI_SCANS_COMMAND_H_
#define CURVEREG_CLI_SCANS_COMMAND_H_

#include "cli/cli_context.h"
#include "program/command_syntax.h"

namespace curvereg::cli {

Command AddScansCommand(CommandSyntax app);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_SCANS_COMMAND_H_
