// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "program/program_arguments.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <utility>
#include <vector>

namespace curvereg {
namespace {

// The command of this name below `command`, or else `command`.
const CLI::App* Enter(const CLI::App* command, const std::string& name) {
  const auto named = command->get_subcommands([&](const CLI::App* below) { return below->get_name() == name; });
  return named.empty() ? command : named.front();
}

// The arguments with `--name=` as two, the name and "".
std::vector<std::string> SplitEmptyValues(const CLI::App& app, const std::vector<std::string>& arguments) {
  std::vector<std::string> split;
  const CLI::App* command = &app;
  for (auto argument = arguments.begin(); argument != arguments.end(); ++argument) {
    if (*argument == "--") {
      split.insert(split.end(), argument, arguments.end());
      break;
    }
    command = Enter(command, *argument);
    const std::size_t equals = argument->find('=');
    const std::string name = argument->substr(0, equals);
    const CLI::Option* option = name.starts_with("--") ? command->get_option_no_throw(name) : nullptr;
    const bool is_switch = option != nullptr && option->get_items_expected_max() == 0;
    if (option != nullptr && equals == argument->size() - 1) {
      if (is_switch) throw CLI::ValidationError(name, "expected true or false, not \"\"");
      split.insert(split.end(), {name, ""});
      continue;
    }
    split.push_back(*argument);
    const bool value_follows = option != nullptr && !is_switch && equals == std::string::npos;
    if (value_follows && argument + 1 != arguments.end()) split.push_back(*++argument);  // whatever it looks like
  }
  return split;
}

}  // namespace

void ParseArguments(CLI::App& app, int argc, const char* const* argv) {
  std::vector<std::string> arguments = SplitEmptyValues(app, {argv + std::min(1, argc), argv + argc});
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
  app.parse(std::move(arguments));
}

std::string CheckNotEmpty(const std::string& text) { return text.empty() ? "must not be empty" : ""; }

}  // namespace curvereg
