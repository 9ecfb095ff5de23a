// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/command_line.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <map>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/register_scans.h"
#include "program/program_arguments.h"
#include "server/settings/setting_values.h"
#include "server/settings/settings.h"

namespace curvereg::server {
namespace {

constexpr int kUsageStatus = 2;

const char* TypeName(SettingKind kind) {
  switch (kind) {
    case SettingKind::kCount:
      return "NUMBER";
    case SettingKind::kBytes:
      return "SIZE";
    default:
      return "TEXT";
  }
}

// Values are read as text here; SetFromText checks them as it does those of the other sources.
void AddSettingFlags(CLI::App& app, std::map<std::string, std::string>& texts) {
  const ServerConfig defaults;
  for (const Setting& setting : AllSettings()) {
    const std::string flag = FlagName(setting);
    const std::string help = absl::StrCat(setting.help, " [", TomlValue(setting, defaults), "]");
    const std::string group = *setting.section == '\0' ? "Settings" : absl::StrCat("Settings: ", setting.section);
    std::string& text = texts[flag];
    CLI::Option* option =
        setting.kind == SettingKind::kSwitch ? app.add_flag(flag, text, help) : app.add_option(flag, text, help);
    option->group(group);
    if (setting.kind != SettingKind::kSwitch) option->type_name(TypeName(setting.kind));
  }
}

CLI::App* AddMakeToken(CLI::App& app, MakeTokenCommand& command, std::string& scope) {
  CLI::App* make_token =
      app.add_subcommand("make-token", "Create a token for a caller and its table for the token file");
  make_token->add_option("NAME", command.name, "name of the caller, as used in the log and for quotas")->required();
  make_token
      ->add_option("--scope", scope,
                   "read (register, download, list), write (also upload and delete) or admin (everything)")
      ->check(CLI::IsMember({"read", "write", "admin"}))
      ->capture_default_str();
  make_token->add_option("--append-to", command.append_to, "token file to append the table to, instead of printing it")
      ->check(CheckNotEmpty);
  return make_token;
}

}  // namespace

ParsedCommandLine ParseCommandLine(int argc, const char* const* argv) {
  CLI::App app("gRPC service that registers 3-D laser scans", "curvereg-server");
  app.set_version_flag("--version", [] { return BuildId(); });
  app.footer(absl::StrCat("Settings may also come from the environment (", kEnvironmentPrefix,
                          "...) and from a TOML file; see docs/settings.md."));
  ServeCommand serve;
  std::map<std::string, std::string> texts;
  app.add_option("--config", serve.config_file, "TOML file of settings")->check(CheckNotEmpty)->type_name("FILE");
  app.add_option("--ports-file", serve.ports_file, "write the bound ports to this file as JSON once they are open")
      ->check(CheckNotEmpty)
      ->type_name("FILE");
  app.add_flag("--print-config", serve.print_config, "print the settings in force as TOML and exit");
  app.add_flag("--print-settings", serve.print_settings, "print the table of all settings as Markdown and exit");
  AddSettingFlags(app, texts);
  MakeTokenCommand token;
  std::string scope = "read";
  const CLI::App* make_token = AddMakeToken(app, token, scope);
  try {
    ParseArguments(app, argc, argv);
  } catch (const CLI::ParseError& error) {
    const int status = app.exit(error);
    return {.command = serve, .is_done = true, .exit_status = status == 0 ? 0 : kUsageStatus};
  }
  if (make_token->parsed()) {
    token.scope = ScopeFromName(scope).value_or(Scope::kRead);
    return {.command = token};
  }
  for (const auto& [flag, text] : texts) {
    if (app.count(flag) > 0) serve.flags.push_back({flag, text});
  }
  return {.command = serve};
}

}  // namespace curvereg::server
