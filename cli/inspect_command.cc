// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/inspect_command.h"

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/argument_parsing.h"
#include "cli/cloud_arguments.h"
#include "cli/progress_bar.h"
#include "cli/service_access.h"
#include "files/atomic_file.h"
#include "files/json.h"
#include "files/result_json.h"
#include "program/command_syntax.h"
#include "wire/resource_names.h"

namespace curvereg::cli {
namespace {

struct Arguments {
  std::string scan;
  std::string gravity;
  std::string out;
  int threads = 0;
  bool json = false;
  ServerArguments server;
};

constexpr char kNotes[] = R"(Pictures, written as PNG files:
  range.png, bearing_angle.png       panoramas: azimuth to the right, elevation upwards; grey where unknown
  coefficients.png                   log10 of the curvelet coefficients of the range image, coarse scales in the centre
  elevation.png, occupancy.png       levelled views from above, x to the right, y upwards, sensor in the centre
  VIEW_doc_J.png                     differences of curvelets I_c(J) - I_c(J-1) of a view: blue below 0, red above
  VIEW_keypoints.png                 key points on the conditioned view: red maxima, blue minima

Exit status: 0 done, 1 internal error or interrupted, 2 wrong arguments or input, 4 server unreachable or refused.

Example:
  curvereg inspect scan_0000.pcd --out pictures)";

absl::StatusOr<RemotePictures> MakePictures(const Arguments& arguments, const CliContext& context) {
  const auto open = [&] { return ServiceAccess::Open(arguments.server, context); };
  if (!arguments.server.server.empty() && wire::IsScanName(arguments.scan)) {
    absl::StatusOr<ServiceAccess> service = open();
    if (!service.ok()) return service.status();
    return service->client().RenderScan(arguments.scan, arguments.threads, context.interrupted);
  }
  absl::StatusOr<Scan> scan = ReadScanArgument(arguments.scan, context);
  if (!scan.ok()) return scan.status();
  if (!arguments.gravity.empty()) {
    const absl::StatusOr<Eigen::Vector3d> gravity = ParseDirection(arguments.gravity);
    if (!gravity.ok()) return gravity.status();
    scan->gravity = *gravity;
  }
  absl::StatusOr<ServiceAccess> service = open();
  if (!service.ok()) return service.status();
  const absl::StatusOr<ScanReference> reference = OfferScan(*service, *scan, context);
  if (!reference.ok()) return reference.status();
  return service->client().RenderScan(*reference, arguments.threads, context.interrupted);
}

absl::Status WritePictures(const RemotePictures& pictures, const std::string& folder) {
  ProgressBar bar("writing pictures");
  for (std::size_t i = 0; i < pictures.pictures.size(); ++i) {
    const RemotePicture& picture = pictures.pictures[i];
    // A server is not trusted with the names of files.
    if (picture.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") != std::string::npos) {
      return absl::DataLossError(absl::StrCat("the server sent a picture with the invalid name '", picture.name, "'"));
    }
    const absl::Status status = WriteFileAtomically(absl::StrCat(folder, "/", picture.name, ".png"), picture.png);
    if (!status.ok()) return status;
    bar.Update(static_cast<double>(i + 1) / static_cast<double>(pictures.pictures.size()), picture.name);
  }
  return absl::OkStatus();
}

std::string ResultLine(const Arguments& arguments, const RemotePictures& pictures) {
  Json files = Json::Array();
  std::string text = absl::StrCat("points       ", pictures.num_points, "\n");
  Json keypoints = Json::Object();
  for (const auto& [view, count] : pictures.num_keypoints) {
    absl::StrAppend(&text, "key points   ", count, " in the ", view, " view\n");
    keypoints[view] = count;
  }
  for (const RemotePicture& named : pictures.pictures) {
    absl::StrAppend(&text, "picture      ", arguments.out, "/", named.name, ".png\n");
    files.Append(absl::StrCat(named.name, ".png"));
  }
  if (!arguments.json) return text;
  return JsonText({{"scan", arguments.scan},
                   {"num_points", pictures.num_points},
                   {"num_keypoints", std::move(keypoints)},
                   {"folder", arguments.out},
                   {"pictures", std::move(files)}}) +
         "\n";
}

ExitCode Run(const Arguments& arguments, const CliContext& context) {
  const absl::Status folder = PrepareOutputFolder(arguments.out);
  if (!folder.ok()) return ReportError(folder);
  const absl::StatusOr<RemotePictures> pictures = MakePictures(arguments, context);
  if (!pictures.ok()) return ReportError(pictures.status());
  const absl::Status written = WritePictures(*pictures, arguments.out);
  if (!written.ok()) return ReportError(written);
  return PrintResult(ResultLine(arguments, *pictures));
}

}  // namespace

Command AddInspectCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command = app.AddCommand("inspect", "Draw every processing stage of a scan");
  command.AddOption("SCAN", arguments->scan, "PCD, PLY, KITTI .bin, XYZ/CSV or LAS, or scans/... of a server")
      .Required();
  command.AddOption("--out", arguments->out, "Folder for the pictures").Required().ValueName("DIR");
  command.AddOption("--gravity", arguments->gravity, "Direction of gravity (down) in the scan's frame")
      .ValueName("X,Y,Z");
  command.AddOption("--threads", arguments->threads, "Maximum number of threads; 0: one per processor")
      .Within(0, 4096)
      .ShowDefault();
  command.AddFlag("--json", arguments->json, "Print one JSON object and nothing else");
  AddServerOptions(command, arguments->server);
  command.SetFooter(kNotes);
  return {.syntax = command, .run = [arguments](const CliContext& context) { return Run(*arguments, context); }};
}

}  // namespace curvereg::cli
