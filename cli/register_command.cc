// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/register_command.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/argument_parsing.h"
#include "cli/cloud_arguments.h"
#include "cli/register_report.h"
#include "cli/result_text.h"
#include "cli/service_access.h"
#include "files/cloud_file.h"
#include "files/json.h"
#include "files/result_json.h"
#include "program/command_syntax.h"
#include "wire/resource_names.h"

namespace curvereg::cli {
namespace {

// As typed; empty texts were not given.
struct Arguments {
  std::string source, target;
  std::string method = "curvelet";
  std::string prior, prior_sigma;
  std::string gravity_source, gravity_target;
  uint64_t seed = 1;
  int threads = 0;
  double time_budget_s = 0.0;
  bool json = false;
  std::string out_cloud, report;
  ServerArguments server;
};

constexpr char kExamples[] =
    R"(With --server, SOURCE and TARGET may also be names of scans stored on the server (scans/...; see curvereg
scans).

Exit status: 0 accepted, 1 internal error or interrupted, 2 wrong arguments or input, 3 rejected, 4 server unreachable
or refused the call.

Examples:
  curvereg register scan_0001.pcd scan_0000.pcd
  curvereg register new.ply old.ply --json > result.json
  curvereg register a.las b.las --prior "5.0 0 0 0 0 0 1" --prior-sigma 0.1,1.0
  curvereg register a.pcd b.pcd --server ground-station:50051
  curvereg register a.pcd b.pcd --gravity-source 0,0,-1 --gravity-target 0,0,-1 --out-cloud merged.ply)";

absl::StatusOr<std::optional<Prior>> PriorOf(const Arguments& arguments) {
  if (arguments.prior.empty()) {
    if (arguments.prior_sigma.empty()) return std::nullopt;
    return absl::InvalidArgumentError("--prior-sigma needs --prior");
  }
  const absl::StatusOr<RigidTransform> T_target_source = ParseTransform(arguments.prior);
  if (!T_target_source.ok()) {
    return absl::Status(T_target_source.status().code(), absl::StrCat("--prior: ", T_target_source.status().message()));
  }
  Prior prior{.T_target_source = *T_target_source, .covariance = std::nullopt};
  if (!arguments.prior_sigma.empty()) {
    const absl::StatusOr<Matrix6d> covariance = ParsePriorSigma(arguments.prior_sigma);
    if (!covariance.ok()) return covariance.status();
    prior.covariance = *covariance;
  }
  return prior;
}

absl::StatusOr<RegistrationOptions> OptionsOf(const Arguments& arguments, const CliContext& context) {
  const absl::StatusOr<Method> method = ParseMethod(arguments.method);
  if (!method.ok()) return method.status();
  const absl::StatusOr<std::optional<Prior>> prior = PriorOf(arguments);
  if (!prior.ok()) return prior.status();
  RegistrationOptions options;
  options.method = *method;
  options.prior = *prior;
  options.seed = arguments.seed;
  options.num_threads = arguments.threads;
  if (arguments.time_budget_s > 0.0) options.time_budget_s = arguments.time_budget_s;
  options.cancellation = context.interrupted;
  return options;
}

// Outputs are checked before the long work, and never written over an input.
absl::Status CheckOutputs(const Arguments& arguments) {
  if (!arguments.out_cloud.empty()) {
    const absl::Status status = CheckOutputFile(arguments.out_cloud);
    if (!status.ok()) return status;
    if (IsSameFile(arguments.out_cloud, arguments.source) || IsSameFile(arguments.out_cloud, arguments.target)) {
      return absl::InvalidArgumentError(absl::StrCat(arguments.out_cloud, ": is also an input of this command"));
    }
    if (!HasWritableCloudEnding(arguments.out_cloud)) {
      return absl::InvalidArgumentError(
          absl::StrCat(arguments.out_cloud, ": cannot be written; expected .pcd, .ply, .bin, .xyz, .csv or .txt"));
    }
  }
  return arguments.report.empty() ? absl::OkStatus() : PrepareOutputFolder(arguments.report);
}

// A scan read from a file, or the name of one that the server keeps.
struct Side {
  std::optional<Scan> scan;
  std::string name;
};

absl::StatusOr<Side> ReadSide(const std::string& argument, const std::string& gravity, const Arguments& arguments,
                              const CliContext& context) {
  if (!arguments.server.server.empty() && wire::IsScanName(argument)) {
    if (gravity.empty()) return Side{.scan = std::nullopt, .name = argument};
    return absl::InvalidArgumentError(absl::StrCat(argument, ": a scan stored on the server has its own gravity"));
  }
  std::optional<Eigen::Vector3d> direction;
  if (!gravity.empty()) {
    const absl::StatusOr<Eigen::Vector3d> parsed = ParseDirection(gravity);
    if (!parsed.ok()) return parsed.status();
    direction = *parsed;
  }
  absl::StatusOr<Scan> scan = ReadScanArgument(argument, context);
  if (!scan.ok()) return scan.status();
  scan->gravity = direction;
  return Side{.scan = *std::move(scan), .name = {}};
}

// The points of a scan that the server keeps, if something is to be made of them.
absl::Status FetchPoints(ServiceAccess& service, const Arguments& arguments, Side& side, const CliContext& context) {
  const bool is_needed = !arguments.out_cloud.empty() || !arguments.report.empty();
  if (side.scan.has_value() || !is_needed) return absl::OkStatus();
  absl::StatusOr<Scan> scan = service.client().DownloadScan(side.name, LosslessTransfer(context));
  if (!scan.ok()) return scan.status();
  side.scan = *std::move(scan);
  return absl::OkStatus();
}

absl::StatusOr<RegistrationResult> RegisterSides(ServiceAccess& service, const Side& source, const Side& target,
                                                 const RegistrationOptions& options, const CliContext& context) {
  const auto refer = [&](const Side& side) -> absl::StatusOr<ScanReference> {
    if (!side.name.empty()) return ScanReference(side.name);
    return OfferScan(service, *side.scan, context);
  };
  const absl::StatusOr<ScanReference> source_reference = refer(source);
  if (!source_reference.ok()) return source_reference.status();
  const absl::StatusOr<ScanReference> target_reference = refer(target);
  if (!target_reference.ok()) return target_reference.status();
  return service.client().RegisterScans(*source_reference, *target_reference, options, kInlineEncoding);
}

// The source in the target frame, then the target.
absl::Status WriteMergedCloud(const std::string& path, const Scan& source, const Scan& target,
                              const RegistrationResult& result) {
  if (!result.T_target_source.has_value()) {
    ReportWarning(absl::StrCat(path, ": not written, because there is no pose"));
    return absl::OkStatus();
  }
  Scan merged = TransformScan(source, *result.T_target_source);
  merged.points.insert(merged.points.end(), target.points.begin(), target.points.end());
  return WriteCloudFile(path, merged);
}

absl::Status WriteOutputs(const Arguments& arguments, const Side& source, const Side& target,
                          const RegistrationResult& result) {
  if (!arguments.out_cloud.empty()) {
    const absl::Status status = WriteMergedCloud(arguments.out_cloud, *source.scan, *target.scan, result);
    if (!status.ok()) return status;
  }
  if (arguments.report.empty()) return absl::OkStatus();
  return WriteRegisterReport(arguments.report, {arguments.source, arguments.target, *source.scan, *target.scan},
                             result);
}

std::string ResultLine(const Arguments& arguments, const RegistrationResult& result) {
  if (!arguments.json) return RegistrationText(result);
  Json json = {{"source", arguments.source}, {"target", arguments.target}, {"method", arguments.method}};
  json.Update(ResultJson(result));
  return JsonText(json) + "\n";
}

ExitCode Run(const Arguments& arguments, const CliContext& context) {
  const absl::StatusOr<RegistrationOptions> options = OptionsOf(arguments, context);
  if (!options.ok()) return ReportError(options.status());
  const absl::Status outputs = CheckOutputs(arguments);
  if (!outputs.ok()) return ReportError(outputs);
  // Before a server is waited for.
  absl::StatusOr<Side> source = ReadSide(arguments.source, arguments.gravity_source, arguments, context);
  if (!source.ok()) return ReportError(source.status());
  absl::StatusOr<Side> target = ReadSide(arguments.target, arguments.gravity_target, arguments, context);
  if (!target.ok()) return ReportError(target.status());
  absl::StatusOr<ServiceAccess> service = ServiceAccess::Open(arguments.server, context);
  if (!service.ok()) return ReportError(service.status());
  for (Side* side : {&*source, &*target}) {
    if (const absl::Status fetched = FetchPoints(*service, arguments, *side, context); !fetched.ok()) {
      return ReportError(fetched);
    }
  }

  const absl::StatusOr<RegistrationResult> result = RegisterSides(*service, *source, *target, *options, context);
  if (!result.ok()) return ReportError(result.status());
  // First what cannot be had again without the work: a full disk must not take it along.
  const ExitCode printed = PrintResult(ResultLine(arguments, *result));
  if (printed != ExitCode::kDone) return printed;
  const absl::Status written = WriteOutputs(arguments, *source, *target, *result);
  if (!written.ok()) return ReportError(written);
  return result->verdict.accepted ? ExitCode::kDone : ExitCode::kRejected;
}

}  // namespace

Command AddRegisterCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command = app.AddCommand("register", "Find the transform that aligns the scan SOURCE to TARGET");
  command
      .AddOption("SOURCE", arguments->source,
                 "Scan to align: PCD, PLY, KITTI .bin, XYZ/CSV or LAS, or scans/... of a server")
      .Required();
  command.AddOption("TARGET", arguments->target, "Reference scan").Required();
  command.AddOption("--method", arguments->method, MethodNames()).ShowDefault().ValueName("NAME");
  command.AddOption("--prior", arguments->prior,
                    "Initial guess of T_target_source: a file or quoted numbers, 16 or 12 (rows of the matrix) or "
                    "\"x y z qx qy qz qw\"");
  command.AddOption("--prior-sigma", arguments->prior_sigma,
                    "Standard deviations of the prior: ROTATION_RAD,TRANSLATION_M");
  command.AddOption("--gravity-source", arguments->gravity_source,
                    "Direction of gravity (down) in the source's frame: X,Y,Z");
  command.AddOption("--gravity-target", arguments->gravity_target, "The same in the target's frame");
  command.AddOption("--seed", arguments->seed, "The same seed gives the same result")
      .Check(CheckNotNegative)
      .ShowDefault();
  command.AddOption("--threads", arguments->threads, "Maximum number of threads; 0: one per processor")
      .Within(0, 4096)
      .ShowDefault();
  command.AddOption("--time-budget", arguments->time_budget_s, "Seconds; when they are over, the best pose so far")
      .Check(CheckSeconds);
  command.AddFlag("--json", arguments->json, "Print one JSON object and nothing else");
  command
      .AddOption(
          "--out-cloud", arguments->out_cloud,
          "Write the source, transformed to the target's frame, together with the target. Needs a pose, accepted "
          "or not: .pcd, .ply, .bin, .xyz, .txt or .csv")
      .ValueName("FILE");
  command.AddOption("--report", arguments->report, "Write result.json and report.html with pictures to this folder")
      .ValueName("DIR");
  AddServerOptions(command, arguments->server);
  command.SetFooter(kExamples);
  return {.syntax = command, .run = [arguments](const CliContext& context) { return Run(*arguments, context); }};
}

}  // namespace curvereg::cli
