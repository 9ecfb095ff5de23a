// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// curvereg evaluate DATASET
#ifndef CURVEREG_CLI_EVALUATE_COMMAND_H_
#define CURVEREG_CLI_EVALUATE_COMMAND_H_

#include "cli/cli_context.h"
#include "program/command_syntax.h"

namespace curvereg::cli {

Command AddEvaluateCommand(CommandSyntax app);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_EVALUATE_COMMAND_H_
