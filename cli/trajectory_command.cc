// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/trajectory_command.h"

#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "cli/traverse_arguments.h"
#include "cli/traverse_text.h"
#include "cli/traverse_trajectory.h"
#include "client/traverses.h"
#include "files/atomic_file.h"
#include "files/json.h"
#include "program/command_syntax.h"

namespace curvereg::cli {
namespace {

struct Arguments {
  TraverseArguments traverse;
  std::string format = "tum";
  std::string out;
  int segment = -1;  // the one with the most poses
};

constexpr char kNotes[] =
    R"(TUM: time, position and quaternion of each scan, 8 columns; the time of the scan, or its sequence number if it
has no time. KITTI: the first three rows of each pose. Both map sensor coordinates to the frame of one segment, metres.
The frames of different segments are unrelated, so a file contains one segment: the one with the most poses, unless
--segment is given.

Exit status: 0 done, 1 internal error or interrupted, 2 wrong arguments or output, 4 server unreachable or refused.

Examples:
  curvereg trajectory sol-12 --out sol-12.tum --server ground-station:50051
  curvereg trajectory sol-12 --json --server ground-station:50051)";

Json TrajectoryJson(const RemoteTrajectory& trajectory) {
  Json json = {{"version", trajectory.version}, {"poses", Json::Array()}};
  for (const TrajectoryPose& pose : trajectory.poses) json["poses"].Append(PoseJson(pose));
  return json;
}

absl::Status NoPoses(const std::string& name, const RemoteTrajectory& trajectory, int segment) {
  if (trajectory.poses.empty()) return absl::NotFoundError(absl::StrCat(name, ": has no poses yet"));
  return absl::NotFoundError(absl::StrCat(name, ": has no poses in segment ", segment));
}

ExitCode Run(const Arguments& arguments, const CliContext& context) {
  if (!arguments.out.empty()) {
    if (const absl::Status output = CheckOutputFile(arguments.out); !output.ok()) return ReportError(output);
  }
  absl::StatusOr<ServiceAccess> service = OpenTraverses(arguments.traverse, DataFolder::kIsThere, context);
  if (!service.ok()) return ReportError(service.status());
  const std::string name = TraverseName(arguments.traverse.id);
  const absl::StatusOr<RemoteTrajectory> trajectory =
      service->client().traverses().GetTrajectory(name, context.UntilInterrupted());
  if (!trajectory.ok()) return ReportError(trajectory.status());
  if (arguments.traverse.json && arguments.out.empty()) {
    return PrintAnswer(arguments.traverse, TrajectoryJson(*trajectory), "");
  }
  const int segment = arguments.segment < 0 ? LargestSegment(trajectory->poses) : arguments.segment;
  const std::vector<StampedPose> poses = PosesOf(trajectory->poses, segment);
  if (poses.empty()) return ReportError(NoPoses(name, *trajectory, segment));
  if (arguments.segment < 0 && poses.size() < trajectory->poses.size()) {
    ReportWarning(absl::StrCat("segment ", segment, " alone, ", poses.size(), " of ", trajectory->poses.size(),
                               " poses; choose another with --segment"));
  }
  const TrajectoryFormat format = arguments.format == "tum" ? TrajectoryFormat::kTum : TrajectoryFormat::kKitti;
  const absl::StatusOr<std::string> text =
      TrajectoryText(poses, format, absl::StrCat("segment ", segment, " of ", name));
  if (!text.ok()) return ReportError(text.status());
  if (arguments.out.empty()) return PrintResult(*text);
  if (const absl::Status written = WriteFileAtomically(arguments.out, *text); !written.ok()) {
    return ReportError(written);
  }
  return PrintAnswer(
      arguments.traverse,
      {{"file", arguments.out}, {"version", trajectory->version}, {"segment", segment}, {"num_poses", poses.size()}},
      absl::StrCat(arguments.out, "  ", poses.size(), " poses\n"));
}

}  // namespace

Command AddTrajectoryCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command = app.AddCommand("trajectory", "Export the poses of a traverse");
  command.AddOption("ID", arguments->traverse.id, "The traverse").Required();
  command.AddOption("--format", arguments->format, "tum or kitti").OneOf({"tum", "kitti"}).ShowDefault();
  command.AddOption("--out", arguments->out, "File to write; default: standard output").ValueName("FILE");
  command.AddOption("--segment", arguments->segment, "Segment to write").Within(0, 1 << 30).ValueName("N");
  AddTraverseOptions(command, arguments->traverse, "Print one JSON object: all poses, or with --out what was written");
  command.SetFooter(kNotes);
  return {.syntax = command, .run = [arguments](const CliContext& context) { return Run(*arguments, context); }};
}

}  // namespace curvereg::cli
