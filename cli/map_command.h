// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// curvereg map ID: the map of a traverse as a file.
#ifndef CURVEREG_CLI_MAP_COMMAND_H_
#define CURVEREG_CLI_MAP_COMMAND_H_

#include "cli/cli_context.h"

namespace curvereg::cli {

Command AddMapCommand(CLI::App& app);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_MAP_COMMAND_H_
