// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the commands about traverses share: which traverse, and where it is kept.
#ifndef CURVEREG_CLI_TRAVERSE_ARGUMENTS_H_
#define CURVEREG_CLI_TRAVERSE_ARGUMENTS_H_

#include <string>

#include "absl/status/statusor.h"
#include "cli/service_access.h"
#include "files/json.h"
#include "program/command_syntax.h"

namespace curvereg::cli {

struct TraverseArguments {
  ServerArguments server;
  std::string data_dir = "curvereg-data";  // of the service in this process, without a server
  std::string id;
  bool json = false;
};

// Declares --data-dir (CURVEREG_DATA_DIR), --json with `json_help`, and the server's options.
void AddTraverseOptions(CommandSyntax command, TraverseArguments& arguments, const std::string& json_help);

// `traverses/ID` for ID, or for what is a name already.
std::string TraverseName(const std::string& id);

// The service: a server's, else one in this process over the data folder. NOT_FOUND: no such folder, unless it
// may begin now; errors of ServiceAccess::OpenWithData.
enum class DataFolder { kIsThere, kMayBegin };
absl::StatusOr<ServiceAccess> OpenTraverses(const TraverseArguments& arguments, DataFolder folder,
                                            const CliContext& context);

// The answer of a command: JSON where that was asked for, else the text. As PrintResult.
ExitCode PrintAnswer(const TraverseArguments& arguments, const Json& json, const std::string& text);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_TRAVERSE_ARGUMENTS_H_
