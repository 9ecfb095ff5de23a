// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/status_command.h"

#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/service_access.h"
#include "files/json.h"
#include "files/result_json.h"
#include "program/command_syntax.h"

namespace curvereg::cli {
namespace {

struct Arguments {
  ServerArguments server;
  bool json = false;
};

constexpr char kNotes[] =
    R"(Without --server it describes the service in this process, not any server.

Exit status: 0 the server serves, 1 internal error or interrupted, 2 wrong arguments, 4 it does not serve, is
unreachable or refused the call.

Example:
  curvereg status --server ground-station:50051)";

std::string StatusText(const std::string& server, const ServerStatus& status) {
  std::string text = absl::StrCat(status.serving ? "serving" : "NOT SERVING", "\nserver       ",
                                  server.empty() ? "none: this process (no --server given)" : server, "\nbuild        ",
                                  status.build_id, "\n");
  absl::StrAppendFormat(&text, "round trip   %.2f ms\n", static_cast<double>(status.round_trip.count()) * 1e-3);
  for (const auto& [service, serving] : status.services) {
    absl::StrAppend(&text, "service      ", service, serving ? "" : " (not serving)", "\n");
  }
  for (const RemoteMethod& method : status.methods) {
    absl::StrAppendFormat(&text, "method       %-15s %s%s\n", method.name,
                          method.available ? "" : "(not in this build) ", method.description);
  }
  for (const auto& [name, value] : status.load) absl::StrAppendFormat(&text, "load         %-30s %d\n", name, value);
  for (const auto& [name, value] : status.limits) absl::StrAppendFormat(&text, "limit        %-30s %d\n", name, value);
  return text;
}

std::string StatusJson(const std::string& server, const ServerStatus& status) {
  Json json = {{"serving", status.serving},   {"server", server},
               {"build_id", status.build_id}, {"round_trip_ms", static_cast<double>(status.round_trip.count()) * 1e-3},
               {"services", Json::Object()},  {"methods", Json::Array()},
               {"load", Json::Object()},      {"limits", Json::Object()}};
  for (const auto& [service, serving] : status.services) json["services"][service] = serving;
  for (const RemoteMethod& method : status.methods) {
    json["methods"].Append(
        {{"name", method.name}, {"description", method.description}, {"available", method.available}});
  }
  for (const auto& [name, value] : status.load) json["load"][name] = value;
  for (const auto& [name, value] : status.limits) json["limits"][name] = value;
  return JsonText(json) + "\n";
}

ExitCode Run(const Arguments& arguments, const CliContext& context) {
  absl::StatusOr<ServiceAccess> service = ServiceAccess::Open(arguments.server, context);
  if (!service.ok()) return ReportError(service.status());
  const absl::StatusOr<ServerStatus> status = service->client().Status(context.UntilInterrupted());
  if (!status.ok()) return ReportError(status.status());
  const std::string& server = arguments.server.server;
  const ExitCode printed = PrintResult(arguments.json ? StatusJson(server, *status) : StatusText(server, *status));
  if (printed != ExitCode::kDone) return printed;
  return status->serving ? ExitCode::kDone : ExitCode::kUnreachable;
}

}  // namespace

Command AddStatusCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command =
      app.AddCommand("status", "Show whether a server serves, its methods, its load and its limits");
  command.AddFlag("--json", arguments->json, "Print one JSON object and nothing else");
  AddServerOptions(command, arguments->server);
  command.SetFooter(kNotes);
  return {.syntax = command, .run = [arguments](const CliContext& context) { return Run(*arguments, context); }};
}

}  // namespace curvereg::cli
