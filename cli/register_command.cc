// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/register_command.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/argument_parsing.h"
#include "cli/cloud_arguments.h"
#include "cli/register_report.h"
#include "cli/result_text.h"
#include "cli/service_access.h"
#include "files/cloud_file.h"
#include "files/result_json.h"

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
    R"(With --server, SOURCE and TARGET may also be names of scans that the server keeps (scans/...; see curvereg scans).

Exit status: 0 accepted, 1 internal fault or interrupted, 2 bad arguments or input, 3 rejected, 4 server unreachable or
it refused.

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
      return absl::InvalidArgumentError(absl::StrCat(arguments.out_cloud, ": is an input of this command"));
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
  if (!arguments.server.server.empty() && IsScanName(argument)) {
    if (gravity.empty()) return Side{.scan = std::nullopt, .name = argument};
    return absl::InvalidArgumentError(absl::StrCat(argument, ": a scan that the server keeps has its own gravity"));
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
    ReportWarning(absl::StrCat(path, ": not written, there is no pose to move the source by"));
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
  nlohmann::ordered_json json = {
      {"source", arguments.source}, {"target", arguments.target}, {"method", arguments.method}};
  json.update(ResultJson(result));
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

Command AddRegisterCommand(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("register", "Find the transform that lays the scan SOURCE on the scan TARGET");
  command
      ->add_option("SOURCE", arguments->source,
                   "Scan to be moved: PCD, PLY, KITTI .bin, XYZ/CSV or LAS, or scans/... of a server")
      ->required();
  command->add_option("TARGET", arguments->target, "Scan to be laid on")->required();
  command->add_option("--method", arguments->method, MethodNames())->capture_default_str()->type_name("NAME");
  command->add_option("--prior", arguments->prior,
                      "Guess of T_target_source: a file or quoted numbers, 16 or 12 (rows of the matrix) or "
                      "\"x y z qx qy qz qw\"");
  command->add_option("--prior-sigma", arguments->prior_sigma,
                      "Standard deviations of the prior: ROTATION_RAD,TRANSLATION_M");
  command->add_option("--gravity-source", arguments->gravity_source,
                      "Direction of gravity (down) in the source's frame: X,Y,Z");
  command->add_option("--gravity-target", arguments->gravity_target, "The same in the target's frame");
  command->add_option("--seed", arguments->seed, "The same seed gives the same result")
      ->check(CheckNotNegative)
      ->capture_default_str();
  command->add_option("--threads", arguments->threads, "Most threads to use; 0: one per processor")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command->add_option("--time-budget", arguments->time_budget_s, "Seconds; then the best pose so far, if any")
      ->check(CheckSeconds);
  command->add_flag("--json", arguments->json, "Print one JSON object and nothing else");
  command
      ->add_option(
          "--out-cloud", arguments->out_cloud,
          "Write the source moved into the target's frame together with the target, if there is a pose, accepted "
          "or not: .pcd, .ply, .bin, .xyz, .txt or .csv")
      ->type_name("FILE");
  command->add_option("--report", arguments->report, "Write result.json and report.html with pictures into this folder")
      ->type_name("DIR");
  AddServerOptions(*command, arguments->server);
  command->footer(kExamples);
  return {.app = command, .run = [arguments](const CliContext& context) { return Run(*arguments, context); }};
}

}  // namespace curvereg::cli
