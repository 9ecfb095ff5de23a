// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "program/command_syntax.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <utility>

namespace curvereg {

OptionSyntax OptionSyntax::Required() {
  option_->required();
  return *this;
}

OptionSyntax OptionSyntax::Within(int least, int most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

OptionSyntax OptionSyntax::Within(double least, double most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

OptionSyntax OptionSyntax::OneOf(std::vector<std::string> values) {
  option_->check(CLI::IsMember(std::move(values)));
  return *this;
}

OptionSyntax OptionSyntax::Check(const std::function<std::string(const std::string& text)>& check) {
  option_->check(check);
  return *this;
}

OptionSyntax OptionSyntax::Excludes(OptionSyntax other) {
  option_->excludes(other.option_);
  return *this;
}

OptionSyntax OptionSyntax::Environment(const std::string& variable) {
  option_->envname(variable);
  return *this;
}

OptionSyntax OptionSyntax::ShowDefault() {
  option_->capture_default_str();
  return *this;
}

OptionSyntax OptionSyntax::ShowDefault(const std::string& text) {
  option_->default_str(text);
  return *this;
}

OptionSyntax OptionSyntax::ValueName(const std::string& name) {
  option_->type_name(name);
  return *this;
}

OptionSyntax OptionSyntax::Group(const std::string& heading) {
  option_->group(heading);
  return *this;
}

CommandSyntax CommandSyntax::AddCommand(const std::string& name, const std::string& help) {
  return CommandSyntax(*app_->add_subcommand(name, help));
}

void CommandSyntax::RequireCommand() { app_->require_subcommand(1); }

OptionSyntax CommandSyntax::AddFlag(const std::string& name, bool& value, const std::string& help) {
  return OptionSyntax(app_->add_flag(name, value, help));
}

OptionSyntax CommandSyntax::AddFlagAction(const std::string& name, const std::function<void()>& action) {
  return OptionSyntax(app_->add_flag_callback(name, action));
}

OptionSyntax CommandSyntax::AddOption(const std::string& name, std::string& value, const std::string& help) {
  return OptionSyntax(app_->add_option(name, value, help));
}

OptionSyntax CommandSyntax::AddOption(const std::string& name, std::vector<std::string>& values,
                                      const std::string& help) {
  return OptionSyntax(app_->add_option(name, values, help));
}

OptionSyntax CommandSyntax::AddOption(const std::string& name, double& value, const std::string& help) {
  return OptionSyntax(app_->add_option(name, value, help));
}

OptionSyntax CommandSyntax::AddOption(const std::string& name, int& value, const std::string& help) {
  return OptionSyntax(app_->add_option(name, value, help));
}

OptionSyntax CommandSyntax::AddOption(const std::string& name, std::uint32_t& value, const std::string& help) {
  return OptionSyntax(app_->add_option(name, value, help));
}

OptionSyntax CommandSyntax::AddOption(const std::string& name, std::uint64_t& value, const std::string& help) {
  return OptionSyntax(app_->add_option(name, value, help));
}

template <typename Value>
OptionSyntax CommandSyntax::AddSetter(const std::string& name, const std::function<void(const Value&)>& set,
                                      const std::string& help) {
  return OptionSyntax(app_->add_option_function<Value>(name, set, help));
}

template OptionSyntax CommandSyntax::AddSetter(const std::string&, const std::function<void(const std::string&)>&,
                                               const std::string&);
template OptionSyntax CommandSyntax::AddSetter(const std::string&, const std::function<void(const double&)>&,
                                               const std::string&);
template OptionSyntax CommandSyntax::AddSetter(const std::string&, const std::function<void(const int&)>&,
                                               const std::string&);
template OptionSyntax CommandSyntax::AddSetter(const std::string&, const std::function<void(const std::uint64_t&)>&,
                                               const std::string&);

void CommandSyntax::SetFooter(const std::string& text) { app_->footer(text); }

bool CommandSyntax::WasNamed() const { return app_->parsed(); }

bool CommandSyntax::WasNamed(const std::string& command) const { return app_->got_subcommand(command); }

}  // namespace curvereg
