// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/watch_command.h"

#include <memory>
#include <string>
#include <utility>

#include "cli/argument_parsing.h"
#include "cli/traverse_arguments.h"
#include "cli/traverse_text.h"
#include "client/traverses.h"
#include "program/command_syntax.h"

namespace curvereg::cli {
namespace {

struct Arguments {
  TraverseArguments traverse;
  uint64_t first_event = 0;
  bool once = false;
};

constexpr char kNotes[] =
    R"(Prints a row for each registered scan, and a line for every other event: poses revised, segments joined, links
found. Ends at ^C. Resumes after connection loss; no event is lost or repeated. sigma: the largest standard deviation
of the position, relative to the first pose of the segment.

Exit status: 0 done (^C is the usual end), 1 internal error, 2 wrong arguments, 4 server unreachable or refused.

Examples:
  curvereg watch sol-12 --server ground-station:50051
  curvereg watch sol-12 --once --json --server ground-station:50051)";

ExitCode Run(const Arguments& arguments, const CliContext& context) {
  absl::StatusOr<ServiceAccess> service = OpenTraverses(arguments.traverse, DataFolder::kIsThere, context);
  if (!service.ok()) return ReportError(service.status());
  std::stop_source unread;  // whoever read our output is gone
  const std::stop_callback interrupt(context.interrupted, [&unread] { unread.request_stop(); });
  WatchOptions options;
  options.first_event = arguments.first_event;
  options.existing_only = arguments.once;
  options.cancellation = unread.get_token();
  ExitCode printed = ExitCode::kDone;
  std::string header = arguments.traverse.json ? "" : ScanResultHeader();
  const absl::Status watched = service->client().traverses().Watch(
      TraverseName(arguments.traverse.id), options, [&](const TraverseEvent& event) {
        if (printed != ExitCode::kDone) return;
        printed = PrintAnswer(arguments.traverse, EventJson(event), std::exchange(header, "") + EventText(event));
        if (printed != ExitCode::kDone) unread.request_stop();
      });
  if (printed != ExitCode::kDone) return printed;
  if (watched.ok() || (absl::IsCancelled(watched) && !arguments.once)) return ExitCode::kDone;
  return ReportError(watched);
}

}  // namespace

Command AddWatchCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command = app.AddCommand("watch", "Show the events of a traverse live");
  command.AddOption("ID", arguments->traverse.id, "The traverse").Required();
  command.AddFlag("--once", arguments->once, "Show the existing events, then end");
  command.AddOption("--from", arguments->first_event, "Number of the first event to show")
      .Check(CheckNotNegative)
      .ValueName("N");
  AddTraverseOptions(command, arguments->traverse, "Print one JSON object a line and nothing else");
  command.SetFooter(kNotes);
  return {.syntax = command, .run = [arguments](const CliContext& context) { return Run(*arguments, context); }};
}

}  // namespace curvereg::cli
