// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/scans_command.h"

#include <unistd.h>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "cli/argument_parsing.h"
#include "cli/cloud_arguments.h"
#include "cli/progress_bar.h"
#include "cli/service_access.h"
#include "files/cloud_file.h"
#include "files/json.h"
#include "files/result_json.h"
#include "program/command_syntax.h"

namespace curvereg::cli {
namespace {

struct Arguments {
  ServerArguments server;
  std::vector<std::string> files;  // to upload
  std::vector<std::string> names;  // to delete
  std::string name, out;           // to download
  std::string encoding = "lossless";
  double max_error_m = 1e-3;
  std::string frame_id;
  bool json = false;
};

constexpr char kNotes[] = R"(Exit status: 0 done, 1 internal error or interrupted, 2 wrong arguments or input,
4 server unreachable or refused the call.

Examples:
  curvereg scans upload scan_0000.pcd scan_0001.pcd --encoding quantized --server ground-station:50051
  curvereg scans list --server ground-station:50051
  curvereg scans download scans/0123456789abcdef0123456789abcdef --out scan.pcd --server ground-station:50051)";

Json ScanJson(const RemoteScan& scan) {
  return {
      {"name", scan.name},
      {"num_points", scan.num_points},
      {"num_finite_points", scan.num_finite_points},
      {"payload_bytes", scan.payload_bytes},
      {"encoding", scan.encoding},
      {"max_error_m", scan.max_error_m},
      {"content_digest", scan.content_digest},
      {"frame_id", scan.frame_id},
      {"create_time", absl::FormatTime(absl::RFC3339_sec, absl::FromChrono(scan.create_time), absl::UTCTimeZone())}};
}

std::string ScanLine(const RemoteScan& scan) {
  return absl::StrFormat("%s  %s  %9d points  %10d bytes  %s\n", scan.name,
                         absl::FormatTime(absl::RFC3339_sec, absl::FromChrono(scan.create_time), absl::UTCTimeZone()),
                         scan.num_points, scan.payload_bytes, scan.encoding);
}

absl::StatusOr<TransferOptions> TransferOf(const Arguments& arguments, const CliContext& context) {
  TransferOptions options;
  options.cancellation = context.interrupted;
  options.frame_id = arguments.frame_id;
  options.encoding.max_error_m = arguments.max_error_m;
  if (arguments.encoding == "raw") {
    options.encoding.kind = TransferEncoding::Kind::kRaw;
  } else if (arguments.encoding == "lossless") {
    options.encoding.kind = TransferEncoding::Kind::kLossless;
  } else {
    options.encoding.kind = TransferEncoding::Kind::kQuantized;
  }
  return options;
}

// A missing file shall not be noticed when others were sent already, or only after the wait for a server.
absl::Status CheckFiles(const std::vector<std::string>& files, const CliContext& context) {
  for (const std::string& file : files) {
    if (access(file.c_str(), R_OK) == 0) continue;
    if (absl::Status status = ReadScanArgument(file, context).status(); !status.ok()) return status;
  }
  return absl::OkStatus();
}

// The same error, with the name of the file.
absl::Status About(const std::string& file, const absl::Status& error) {
  absl::Status named(error.code(), absl::StrCat(file, ": ", error.message()));
  error.ForEachPayload([&](absl::string_view type, const absl::Cord& payload) { named.SetPayload(type, payload); });
  return named;
}

absl::StatusOr<UploadOutcome> UploadFile(Client& client, const std::string& file, TransferOptions options,
                                         const CliContext& context) {
  const absl::StatusOr<Scan> scan = ReadScanArgument(file, context);
  if (!scan.ok()) return scan.status();
  ProgressBar bar(file);
  options.progress = [&](const TransferProgress& progress) {
    bar.Update(static_cast<double>(progress.bytes_done) / static_cast<double>(progress.bytes_total),
               progress.num_resumes == 0 ? "" : absl::StrCat("resumed ", progress.num_resumes, " times"));
  };
  absl::StatusOr<UploadOutcome> outcome = client.UploadScan(*scan, options);
  if (!outcome.ok()) return About(file, outcome.status());
  return outcome;
}

ExitCode Upload(const Arguments& arguments, Client& client, const CliContext& context) {
  const absl::StatusOr<TransferOptions> options = TransferOf(arguments, context);
  if (!options.ok()) return ReportError(options.status());
  Json json = Json::Array();
  for (const std::string& file : arguments.files) {
    const absl::StatusOr<UploadOutcome> outcome = UploadFile(client, file, *options, context);
    if (!outcome.ok()) return ReportError(outcome.status());
    Json entry = {{"file", file}, {"already_stored", outcome->already_stored}};
    entry.Update(ScanJson(outcome->scan));
    json.Append(std::move(entry));
    if (arguments.json) continue;
    // Immediately: the names of stored scans are printed even if a later file fails.
    const ExitCode printed = PrintResult(
        absl::StrCat(outcome->scan.name, "  ", file, outcome->already_stored ? "  (already stored)\n" : "\n"));
    if (printed != ExitCode::kDone) return printed;
  }
  return arguments.json ? PrintResult(JsonText({{"scans", std::move(json)}}) + "\n") : ExitCode::kDone;
}

ExitCode List(const Arguments& arguments, Client& client, const CliContext& context) {
  const absl::StatusOr<std::vector<RemoteScan>> scans = client.ListScans(context.UntilInterrupted());
  if (!scans.ok()) return ReportError(scans.status());
  Json json = Json::Array();
  std::string text;
  for (const RemoteScan& scan : *scans) {
    json.Append(ScanJson(scan));
    text += ScanLine(scan);
  }
  return PrintResult(arguments.json ? JsonText({{"scans", std::move(json)}}) + "\n" : text);
}

ExitCode Download(const Arguments& arguments, Client& client, const CliContext& context) {
  const absl::Status output = CheckOutputFile(arguments.out);
  if (!output.ok()) return ReportError(output);
  if (!HasWritableCloudEnding(arguments.out)) {
    return ReportError(absl::InvalidArgumentError(
        absl::StrCat(arguments.out, ": cannot be written; expected .pcd, .ply, .bin, .xyz, .csv or .txt")));
  }
  absl::StatusOr<Scan> scan;
  {
    ProgressBar bar("downloading");
    TransferOptions options;
    options.cancellation = context.interrupted;
    options.progress = [&](const TransferProgress& progress) {
      bar.Update(static_cast<double>(progress.bytes_done) / static_cast<double>(progress.bytes_total));
    };
    scan = client.DownloadScan(arguments.name, options);
  }
  if (!scan.ok()) return ReportError(scan.status());
  const absl::Status written = WriteCloudFile(arguments.out, *scan);
  if (!written.ok()) return ReportError(written);
  if (arguments.json) {
    return PrintResult(
        JsonText({{"name", arguments.name}, {"file", arguments.out}, {"num_points", scan->points.size()}}) + "\n");
  }
  return PrintResult(absl::StrCat(arguments.out, "  ", scan->points.size(), " points\n"));
}

ExitCode Delete(const Arguments& arguments, Client& client, const CliContext& context) {
  for (const std::string& name : arguments.names) {
    const absl::Status status = client.DeleteScan(name, context.UntilInterrupted());
    if (!status.ok()) return ReportError(status);
  }
  if (arguments.json) return PrintResult(JsonText({{"deleted", arguments.names}}) + "\n");
  return ExitCode::kDone;
}

ExitCode Run(const CommandSyntax& command, const Arguments& arguments, const CliContext& context) {
  if (arguments.server.server.empty()) {
    return ReportError(
        absl::InvalidArgumentError("scans are stored on servers: give --server HOST:PORT, or set CURVEREG_SERVER"));
  }
  if (const absl::Status files = CheckFiles(arguments.files, context); !files.ok()) return ReportError(files);
  absl::StatusOr<ServiceAccess> service = ServiceAccess::Open(arguments.server, context);
  if (!service.ok()) return ReportError(service.status());
  if (command.WasNamed("upload")) return Upload(arguments, service->client(), context);
  if (command.WasNamed("list")) return List(arguments, service->client(), context);
  if (command.WasNamed("download")) return Download(arguments, service->client(), context);
  return Delete(arguments, service->client(), context);
}

CommandSyntax AddAction(CommandSyntax command, const std::string& name, const std::string& help, Arguments& arguments) {
  CommandSyntax action = command.AddCommand(name, help);
  action.AddFlag("--json", arguments.json, "Print one JSON object and nothing else");
  AddServerOptions(action, arguments.server);
  return action;
}

}  // namespace

Command AddScansCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command = app.AddCommand("scans", "Manage the scans stored on a server");
  command.RequireCommand();
  CommandSyntax upload =
      AddAction(command, "upload", "Upload scans to a server; resumes after connection loss", *arguments);
  upload.AddOption("FILE", arguments->files, "PCD, PLY, KITTI .bin, XYZ/CSV or LAS").Required();
  upload.AddOption("--encoding", arguments->encoding, "raw, lossless (compressed) or quantized (smallest)")
      .OneOf({"raw", "lossless", "quantized"})
      .ShowDefault();
  upload.AddOption("--max-error", arguments->max_error_m, "With quantized: maximum error of a point [m]")
      .Check(CheckPositive)
      .ShowDefault();
  upload.AddOption("--frame", arguments->frame_id, "Name of the sensor frame, stored with the scan").ValueName("NAME");
  AddAction(command, "list", "List the scans, newest first", *arguments);
  CommandSyntax download = AddAction(command, "download", "Download a scan", *arguments);
  download.AddOption("NAME", arguments->name, "scans/...").Required();
  download.AddOption("--out", arguments->out, "File to write: .pcd, .ply, .bin, .xyz, .csv or .txt")
      .Required()
      .ValueName("FILE");
  AddAction(command, "delete", "Delete scans", *arguments).AddOption("NAME", arguments->names, "scans/...").Required();
  command.SetFooter(kNotes);
  return {.syntax = command,
          .run = [arguments, command](const CliContext& context) { return Run(command, *arguments, context); }};
}

}  // namespace curvereg::cli
