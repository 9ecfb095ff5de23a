// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The options and arguments of a command. CLI11 parses them; its templates are compiled in this one place instead of in
// every command, where they cost more than the command itself.
#ifndef CURVEREG_PROGRAM_COMMAND_SYNTAX_H_
#define CURVEREG_PROGRAM_COMMAND_SYNTAX_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace curvereg {

// An option or argument that was declared; each call adds a property and returns the option.
class OptionSyntax {
 public:
  explicit OptionSyntax(CLI::Option* option) : option_(option) {}

  OptionSyntax Required();
  OptionSyntax Within(int least, int most);
  OptionSyntax Within(double least, double most);
  OptionSyntax OneOf(std::vector<std::string> values);
  // `check` returns what is wrong with the text, or an empty string.
  OptionSyntax Check(const std::function<std::string(const std::string& text)>& check);
  OptionSyntax Excludes(OptionSyntax other);
  OptionSyntax Environment(const std::string& variable);  // read where the option is not given
  // What the help shows: the present value as default, this text as default, the name of the value, the heading.
  OptionSyntax ShowDefault();
  OptionSyntax ShowDefault(const std::string& text);
  OptionSyntax ValueName(const std::string& name);
  OptionSyntax Group(const std::string& heading);

 private:
  CLI::Option* option_;
};

// A command, a handle of what the parser owns. Names as CLI11 has them: "--name" is an option, "NAME" an argument.
// Values live until the command line is parsed, and keep what they hold where an option is not given.
class CommandSyntax {
 public:
  explicit CommandSyntax(CLI::App& app) : app_(&app) {}

  CommandSyntax AddCommand(const std::string& name, const std::string& help);
  void RequireCommand();  // exactly one of those added

  OptionSyntax AddFlag(const std::string& name, bool& value, const std::string& help);
  OptionSyntax AddFlagAction(const std::string& name, const std::function<void()>& action);  // called when it is given
  OptionSyntax AddOption(const std::string& name, std::string& value, const std::string& help);
  OptionSyntax AddOption(const std::string& name, std::vector<std::string>& values, const std::string& help);
  OptionSyntax AddOption(const std::string& name, double& value, const std::string& help);
  OptionSyntax AddOption(const std::string& name, int& value, const std::string& help);
  OptionSyntax AddOption(const std::string& name, std::uint32_t& value, const std::string& help);
  OptionSyntax AddOption(const std::string& name, std::uint64_t& value, const std::string& help);
  // `set` is called with the value when the option is given. Value: std::string, double, int, std::uint64_t.
  template <typename Value>
  OptionSyntax AddSetter(const std::string& name, const std::function<void(const Value&)>& set,
                         const std::string& help);

  void SetFooter(const std::string& text);  // below the help

  // After parsing: whether this command was named, and whether `command` was below it.
  bool WasNamed() const;
  bool WasNamed(const std::string& command) const;

 private:
  CLI::App* app_;
};

}  // namespace curvereg

#endif  // CURVEREG_PROGRAM_COMMAND_SYNTAX_H_
