// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/traverse_arguments.h"

namespace curvereg::cli {
namespace {

constexpr char kPrefix[] = "traverses/";

}  // namespace

void AddTraverseOptions(CLI::App& command, TraverseArguments& arguments, const std::string& json_help) {
  command.add_flag("--json", arguments.json, json_help);
  command.add_option("--data-dir", arguments.data_dir, "Without --server: folder that keeps traverses and scans")
      ->envname("CURVEREG_DATA_DIR")
      ->type_name("DIR")
      ->capture_default_str();
  AddServerOptions(command, arguments.server);
}

std::string TraverseName(const std::string& id) { return id.starts_with(kPrefix) ? id : kPrefix + id; }

absl::StatusOr<ServiceAccess> OpenTraverses(const TraverseArguments& arguments) {
  return ServiceAccess::OpenWithData(arguments.server, arguments.data_dir);
}

}  // namespace curvereg::cli
