// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/map_command.h"

#include <filesystem>
#include <memory>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "cli/argument_parsing.h"
#include "cli/progress_bar.h"
#include "cli/traverse_arguments.h"
#include "client/traverses.h"
#include "files/atomic_file.h"
#include "files/cloud_file.h"
#include "program/command_syntax.h"

namespace curvereg::cli {
namespace {

struct Arguments {
  TraverseArguments traverse;
  std::string out;
  MapOptions map;
};

constexpr char kNotes[] =
    R"(.pcd, .ply and the other extensions of point clouds: points, one per cell. .asc: heights, an ESRI ASCII grid. In
the frame of the segment, metres. The download resumes after connection loss.

Exit status: 0 done, 1 internal error or interrupted, 2 wrong arguments or output, 4 server unreachable or refused.

Examples:
  curvereg map sol-12 --out sol-12.ply --cell 0.05 --remove-dynamic --server ground-station:50051
  curvereg map sol-12 --out sol-12.asc --cell 0.2 --server ground-station:50051)";

bool IsGrid(const std::string& path) {
  return absl::AsciiStrToLower(std::filesystem::path(path).extension().string()) == ".asc";
}

absl::Status CheckOutput(const std::string& path) {
  if (absl::Status status = CheckOutputFile(path); !status.ok()) return status;
  if (IsGrid(path) || HasWritableCloudEnding(path)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": cannot be written; expected .pcd, .ply, .asc, .bin, .xyz, .csv or .txt"));
}

ExitCode Run(const Arguments& arguments, const CliContext& context) {
  if (const absl::Status output = CheckOutput(arguments.out); !output.ok()) return ReportError(output);
  absl::StatusOr<ServiceAccess> service = OpenTraverses(arguments.traverse, DataFolder::kIsThere, context);
  if (!service.ok()) return ReportError(service.status());
  absl::StatusOr<RemoteMap> map;
  {
    ProgressBar bar("downloading");
    MapOptions options = arguments.map;
    options.kind = IsGrid(arguments.out) ? MapOptions::Kind::kElevationAscii : MapOptions::Kind::kPoints;
    options.cancellation = context.interrupted;
    options.progress = [&bar](const TransferProgress& progress) {
      bar.Update(static_cast<double>(progress.bytes_done) / static_cast<double>(progress.bytes_total));
    };
    map = service->client().traverses().DownloadMap(TraverseName(arguments.traverse.id), options);
  }
  if (!map.ok()) return ReportError(map.status());
  const absl::Status written = IsGrid(arguments.out)
                                   ? WriteFileAtomically(arguments.out, map->text)
                                   : WriteCloudFile(arguments.out, {std::move(map->points), std::nullopt});
  if (!written.ok()) return ReportError(written);
  return PrintAnswer(arguments.traverse,
                     {{"file", arguments.out}, {"version", map->version}, {"num_cells", map->num_cells}},
                     absl::StrCat(arguments.out, "  ", map->num_cells, " cells\n"));
}

}  // namespace

Command AddMapCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command = app.AddCommand("map", "Export the map of a traverse");
  command.AddOption("ID", arguments->traverse.id, "The traverse").Required();
  command.AddOption("--out", arguments->out, "File to write: .pcd or .ply (points), .asc (heights)")
      .Required()
      .ValueName("FILE");
  command.AddOption("--cell", arguments->map.cell_m, "Edge of a cell [m]")
      .Within(0.01, 10.0)
      .ShowDefault()
      .ValueName("M");
  command.AddOption("--segment", arguments->map.segment, "Segment to map")
      .Within(0, 1 << 30)
      .ShowDefault()
      .ValueName("N");
  command.AddFlag("--remove-dynamic", arguments->map.remove_dynamic,
                  "Remove points that lie in the free space of other scans (dynamic objects)");
  // The option's old name, for one release.
  command
      .AddFlagAction("--remove-seen-through",
                     [arguments] {
                       ReportWarning(
                           "--remove-seen-through is called --remove-dynamic now; the old name will "
                           "not be accepted in the next release");
                       arguments->map.remove_dynamic = true;
                     })
      .Group("");
  AddTraverseOptions(command, arguments->traverse, "Print one JSON object and nothing else");
  command.SetFooter(kNotes);
  return {.syntax = command, .run = [arguments](const CliContext& context) { return Run(*arguments, context); }};
}

}  // namespace curvereg::cli
