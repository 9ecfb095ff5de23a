// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/traverse_command.h"

#include <memory>
#include <string>
#include <variant>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "cli/progress_bar.h"
#include "cli/traverse_arguments.h"
#include "cli/traverse_report.h"
#include "cli/traverse_text.h"
#include "cli/traverse_trajectory.h"
#include "client/traverses.h"
#include "core/methods/registration_names.h"
#include "files/json.h"
#include "program/command_syntax.h"

namespace curvereg::cli {
namespace {

struct Arguments {
  TraverseArguments traverse;
  std::string out;
  double cell_m = 0.2;
  bool without_loops = false;
};

constexpr char kNotes[] =
    R"(Exit status: 0 done, 1 internal error or interrupted, 2 wrong arguments or output, 4 server unreachable or
refused.

Examples:
  curvereg traverse list --server ground-station:50051
  curvereg traverse optimize sol-12 --server ground-station:50051
  curvereg traverse report sol-12 --out sol-12-report --server ground-station:50051)";

std::string Line(const RemoteTraverse& traverse) {
  return absl::StrFormat(
      "%s  %s  %6d scans  %3d segments  %10.2f m\n", traverse.name,
      absl::FormatTime(absl::RFC3339_sec, absl::FromChrono(traverse.create_time), absl::UTCTimeZone()),
      traverse.num_registered_scans, traverse.num_segments, traverse.path_length_m);
}

std::string Description(const RemoteTraverse& traverse) {
  const TraverseSettings& settings = traverse.settings;
  std::string text = absl::StrCat(traverse.name, "\n");
  absl::StrAppendFormat(
      &text, "created      %s\n",
      absl::FormatTime(absl::RFC3339_sec, absl::FromChrono(traverse.create_time), absl::UTCTimeZone()));
  absl::StrAppend(&text, "scans        ", traverse.next_sequence_number, " acknowledged, ",
                  traverse.num_registered_scans, " registered\n", "segments     ", traverse.num_segments, "\n",
                  "trajectory   version ", traverse.trajectory_version, "\n");
  absl::StrAppendFormat(&text, "driven       %.3f m\n", traverse.path_length_m);
  absl::StrAppend(&text, "method       ", std::string(MethodName(settings.registration.method)), ", seed ",
                  settings.registration.seed, "\n", "late scans   up to ", settings.reorder_window, " numbers\n",
                  "optimised    ", settings.optimize_on_the_fly ? "while scans arrive\n" : "on request\n");
  return text;
}

ExitCode List(const Arguments& arguments, TraverseClient& client, const CliContext& context) {
  const absl::StatusOr<std::vector<RemoteTraverse>> traverses = client.List(context.UntilInterrupted());
  if (!traverses.ok()) return ReportError(traverses.status());
  Json json = Json::Array();
  std::string text;
  for (const RemoteTraverse& traverse : *traverses) {
    json.Append(TraverseJson(traverse));
    text += Line(traverse);
  }
  return PrintAnswer(arguments.traverse, {{"traverses", std::move(json)}}, text);
}

ExitCode Show(const Arguments& arguments, TraverseClient& client, const CliContext& context) {
  const absl::StatusOr<RemoteTraverse> traverse =
      client.Get(TraverseName(arguments.traverse.id), context.UntilInterrupted());
  if (!traverse.ok()) return ReportError(traverse.status());
  return PrintAnswer(arguments.traverse, TraverseJson(*traverse), Description(*traverse));
}

ExitCode Optimize(const Arguments& arguments, TraverseClient& client, const CliContext& context) {
  const absl::StatusOr<OptimizationOutcome> outcome =
      client.Optimize(TraverseName(arguments.traverse.id), !arguments.without_loops, context.interrupted);
  if (!outcome.ok()) return ReportError(outcome.status());
  return PrintAnswer(arguments.traverse, OptimizationJson(*outcome), OptimizationText(*outcome));
}

ExitCode Delete(const Arguments& arguments, TraverseClient& client, const CliContext& context) {
  const std::string name = TraverseName(arguments.traverse.id);
  if (const absl::Status status = client.Delete(name, context.UntilInterrupted()); !status.ok())
    return ReportError(status);
  return PrintAnswer(arguments.traverse, {{"deleted", name}}, "");
}

absl::Status ReadEvents(TraverseClient& client, const CliContext& context, TraverseRecord& record) {
  WatchOptions options;
  options.existing_only = true;
  options.cancellation = context.interrupted;
  return client.Watch(record.traverse.name, options, [&record](const TraverseEvent& event) {
    if (const auto* result = std::get_if<ScanResult>(&event.what)) record.results.push_back(*result);
    if (const auto* found = std::get_if<LinksFound>(&event.what)) {
      record.later_links.insert(record.later_links.end(), found->links.begin(), found->links.end());
    }
  });
}

absl::Status ReadMap(TraverseClient& client, double cell_m, const CliContext& context, TraverseRecord& record) {
  if (record.trajectory.poses.empty()) return absl::OkStatus();
  ProgressBar bar("downloading the map");
  MapOptions options;
  options.cell_m = cell_m;
  options.segment = LargestSegment(record.trajectory.poses);
  options.cancellation = context.interrupted;
  options.progress = [&bar](const TransferProgress& progress) {
    bar.Update(static_cast<double>(progress.bytes_done) / static_cast<double>(progress.bytes_total));
  };
  absl::StatusOr<RemoteMap> map = client.DownloadMap(record.traverse.name, options);
  if (!map.ok()) return map.status();
  record.map = std::move(map->points);
  return absl::OkStatus();
}

absl::StatusOr<TraverseRecord> ReadRecord(const Arguments& arguments, TraverseClient& client,
                                          const CliContext& context) {
  TraverseRecord record;
  absl::StatusOr<RemoteTraverse> traverse = client.Get(TraverseName(arguments.traverse.id), context.UntilInterrupted());
  if (!traverse.ok()) return traverse.status();
  record.traverse = *std::move(traverse);
  absl::StatusOr<RemoteTrajectory> trajectory = client.GetTrajectory(record.traverse.name, context.UntilInterrupted());
  if (!trajectory.ok()) return trajectory.status();
  record.trajectory = *std::move(trajectory);
  absl::Status read = ReadEvents(client, context, record);
  if (read.ok()) read = ReadMap(client, arguments.cell_m, context, record);
  if (!read.ok()) return read;
  return record;
}

ExitCode Report(const Arguments& arguments, TraverseClient& client, const CliContext& context) {
  if (const absl::Status folder = PrepareOutputFolder(arguments.out); !folder.ok()) return ReportError(folder);
  const absl::StatusOr<TraverseRecord> record = ReadRecord(arguments, client, context);
  if (!record.ok()) return ReportError(record.status());
  const absl::StatusOr<std::string> warning = WriteTraverseReport(*record, arguments.out);
  if (!warning.ok()) return ReportError(warning.status());
  if (!warning->empty()) ReportWarning(*warning);
  const std::string page = arguments.out + "/report.html";
  return PrintAnswer(arguments.traverse,
                     {{"report", page},
                      {"version", record->trajectory.version},
                      {"num_poses", record->trajectory.poses.size()},
                      {"num_map_points", record->map.size()}},
                     page + "\n");
}

ExitCode Run(const CommandSyntax& command, const Arguments& arguments, const CliContext& context) {
  absl::StatusOr<ServiceAccess> service = OpenTraverses(arguments.traverse, DataFolder::kIsThere, context);
  if (!service.ok()) return ReportError(service.status());
  TraverseClient& client = service->client().traverses();
  if (command.WasNamed("list")) return List(arguments, client, context);
  if (command.WasNamed("show")) return Show(arguments, client, context);
  if (command.WasNamed("optimize")) return Optimize(arguments, client, context);
  if (command.WasNamed("report")) return Report(arguments, client, context);
  return Delete(arguments, client, context);
}

CommandSyntax AddAction(CommandSyntax command, const std::string& name, const std::string& help, Arguments& arguments) {
  CommandSyntax action = command.AddCommand(name, help);
  AddTraverseOptions(action, arguments.traverse, "Print one JSON object and nothing else");
  return action;
}

CommandSyntax AddActionOnOne(CommandSyntax command, const std::string& name, const std::string& help,
                             Arguments& arguments) {
  CommandSyntax action = AddAction(command, name, help, arguments);
  action.AddOption("ID", arguments.traverse.id, "The traverse").Required();
  return action;
}

}  // namespace

Command AddTraverseCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command = app.AddCommand("traverse", "Manage traverses");
  command.RequireCommand();
  AddAction(command, "list", "List the traverses, newest first", *arguments);
  AddActionOnOne(command, "show", "Show the state of a traverse", *arguments);
  AddActionOnOne(command, "optimize", "Search for loop closures and optimise all poses", *arguments)
      .AddFlag("--without-loops", arguments->without_loops, "Optimise with the existing links only");
  AddActionOnOne(command, "delete", "Delete a traverse, and its scans that no other traverse uses", *arguments);
  CommandSyntax report =
      AddActionOnOne(command, "report", "Write trajectory, map, verdicts and an HTML report", *arguments);
  report.AddOption("--out", arguments->out, "Folder for report.html, report.json, figures, trajectories and the map")
      .Required()
      .ValueName("DIR");
  report.AddOption("--cell", arguments->cell_m, "Edge of a cell of the map [m]")
      .Within(0.01, 10.0)
      .ShowDefault()
      .ValueName("M");
  command.SetFooter(kNotes);
  return {.syntax = command,
          .run = [arguments, command](const CliContext& context) { return Run(command, *arguments, context); }};
}

}  // namespace curvereg::cli
