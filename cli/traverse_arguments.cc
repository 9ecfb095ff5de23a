// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/traverse_arguments.h"

#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "files/json.h"
#include "files/result_json.h"
#include "program/command_syntax.h"
#include "wire/resource_names.h"

namespace curvereg::cli {

void AddTraverseOptions(CommandSyntax command, TraverseArguments& arguments, const std::string& json_help) {
  command.AddFlag("--json", arguments.json, json_help);
  command.AddOption("--data-dir", arguments.data_dir, "Without --server: folder that stores traverses and scans")
      .Environment("CURVEREG_DATA_DIR")
      .ValueName("DIR")
      .ShowDefault();
  AddServerOptions(command, arguments.server);
}

std::string TraverseName(const std::string& id) {
  return id.starts_with(wire::kTraversePrefix) ? id : wire::TraverseName(id);
}

absl::StatusOr<ServiceAccess> OpenTraverses(const TraverseArguments& arguments, DataFolder folder,
                                            const CliContext& context) {
  std::error_code error;
  const bool is_local = arguments.server.server.empty() && !arguments.data_dir.empty();
  if (is_local && folder == DataFolder::kIsThere && !std::filesystem::exists(arguments.data_dir, error)) {
    return absl::NotFoundError(absl::StrCat(arguments.data_dir,
                                            ": no such data folder; give the one that `stream` wrote with --data-dir, "
                                            "or a server with --server"));
  }
  return ServiceAccess::OpenWithData(arguments.server, arguments.data_dir, context);
}

ExitCode PrintAnswer(const TraverseArguments& arguments, const Json& json, const std::string& text) {
  return PrintResult(arguments.json ? JsonText(json) + "\n" : text);
}

}  // namespace curvereg::cli
