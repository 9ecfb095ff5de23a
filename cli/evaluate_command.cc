// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/evaluate_command.h"

#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/argument_parsing.h"
#include "cli/progress_bar.h"
#include "cli/result_text.h"
#include "cli/service_registrar.h"
#include "eval/evaluate.h"
#include "eval/evaluate_traverse.h"
#include "eval/report.h"
#include "eval/report_json.h"
#include "eval/traverse_evaluation_report.h"
#include "files/cloud_file.h"
#include "program/command_syntax.h"

namespace curvereg::cli {
namespace {

struct Arguments {
  std::string dataset;
  std::string methods = "curvelet";
  std::string mode = "pairs";
  PairSelection selection;
  uint64_t seed = 1;
  int threads = 0;
  double time_budget_s = 0.0;
  std::string out;
  bool json = false;
  ServerArguments server;
};

constexpr char kExamples[] =
    R"(A data set is a folder of scans in name order with poses.txt (TUM: sensor to world) or pairs.txt (lines
`source target overlap ... 16 numbers`, row-major T_target_source). negatives.txt, where present, lists pairs
`source target` that share no ground: accepting one is wrong.

--mode pairs registers the pairs one by one. --mode traverse tracks the scans in name order as one drive and then
optimises it, in this process, with the first of the methods. Trajectory errors need a poses.txt; the sharpness of the
map is measured without ground truth.

Exit status: 0 done (whatever the results), 1 internal error or interrupted, 2 wrong arguments or input, 4 server
unreachable or refused the call. If every call fails there is no report, and the status is that of the last call.

Examples:
  curvereg evaluate yard --out yard-report
  curvereg evaluate dome --method curvelet,paper --every 5 --out dome-report --json > dome.json
  curvereg evaluate yard --mode traverse --out yard-drive)";

absl::StatusOr<Scan> LoadScan(const std::string& path) { return ReadCloudFile(path); }

std::string ProgressNote(const EvaluationProgress& progress) {
  return absl::StrCat(progress.num_done, "/", progress.num_total, " ", progress.last->source, " → ",
                      progress.last->target);
}

// What both modes take from the command line.
RegistrationOptions RegistrationOf(const Arguments& arguments, const CliContext& context) {
  RegistrationOptions registration;
  registration.seed = arguments.seed;
  registration.num_threads = arguments.threads;
  if (arguments.time_budget_s > 0.0) registration.time_budget_s = arguments.time_budget_s;
  registration.cancellation = context.interrupted;
  return registration;
}

absl::StatusOr<Evaluation> EvaluateWithProgress(const Arguments& arguments, const Dataset& dataset,
                                                const CliContext& context) {
  if (const std::string path = NegativePairsFile(dataset.folder); IsOldNegativePairsFile(path)) {
    ReportWarning(
        absl::StrCat(path, ": is called negatives.txt now; the old name will not be read in the next release"));
  }
  const absl::StatusOr<std::vector<NegativePair>> negatives = LoadNegativePairs(dataset);
  if (!negatives.ok()) return negatives.status();
  const absl::StatusOr<std::vector<Method>> methods = ParseMethods(arguments.methods);
  if (!methods.ok()) return methods.status();

  absl::StatusOr<ServiceAccess> service = ServiceAccess::Open(arguments.server, context);
  if (!service.ok()) return service.status();
  ServiceRegistrar registrar(*service);
  ProgressBar bar("registering");
  EvaluationOptions options;
  options.methods = *methods;
  options.registration = RegistrationOf(arguments, context);
  options.load_scan = LoadScan;
  options.register_scans = [&](const Scan& source, const Scan& target, const RegistrationOptions& registration) {
    return registrar.Register(source, target, registration);
  };
  bool has_warned = false;
  options.progress = [&](const EvaluationProgress& progress) {
    const bool failed = !progress.last->error.empty();
    if (failed && !std::exchange(has_warned, true)) {
      ReportWarning(absl::StrCat("a call failed: ", progress.last->error));
    }
    bar.Update(static_cast<double>(progress.num_done) / progress.num_total, ProgressNote(progress));
  };
  return Evaluate(dataset, *negatives, options);
}

ExitCode RunTraverse(const Arguments& arguments, const Dataset& dataset, Method method, const CliContext& context) {
  if (!arguments.server.server.empty()) {
    return ReportError(absl::InvalidArgumentError(
        "--mode traverse runs in this process; omit --server, or override CURVEREG_SERVER with --server \"\""));
  }
  TraverseEvaluationOptions options;
  options.tracking.registration = RegistrationOf(arguments, context);
  options.tracking.registration.method = method;
  options.load_scan = LoadScan;
  ProgressBar bar("tracking");
  const auto num_scans = static_cast<double>(dataset.scan_paths.size());
  options.progress = [&](int num_done, const std::string& name) { bar.Update(num_done / num_scans, name); };
  const absl::StatusOr<TraverseEvaluation> evaluation = EvaluateTraverse(dataset, options);
  if (!evaluation.ok()) return ReportError(evaluation.status());
  ReportOptions report;
  report.load_scan = LoadScan;
  const absl::StatusOr<std::string> warning =
      WriteTraverseEvaluationReport(*evaluation, dataset, arguments.out, report);
  if (!warning.ok()) return ReportError(warning.status());
  if (!warning->empty()) ReportWarning(*warning);
  if (arguments.json) return PrintResult(TraverseEvaluationJson(*evaluation) + "\n");
  return PrintResult(
      absl::StrCat(TraverseEvaluationText(*evaluation), "report       ", arguments.out, "/report.html\n"));
}

ExitCode Run(const Arguments& arguments, const CliContext& context) {
  const absl::StatusOr<std::vector<Method>> methods = ParseMethods(arguments.methods);
  if (!methods.ok()) return ReportError(methods.status());
  PairSelection selection = arguments.selection;
  selection.needs_truth = arguments.mode == "pairs";
  const absl::StatusOr<Dataset> dataset = LoadDataset(arguments.dataset, selection);
  if (!dataset.ok()) return ReportError(dataset.status());
  const absl::Status folder = PrepareOutputFolder(arguments.out);
  if (!folder.ok()) return ReportError(folder);
  if (arguments.mode == "traverse") return RunTraverse(arguments, *dataset, methods->front(), context);

  const absl::StatusOr<Evaluation> evaluation = EvaluateWithProgress(arguments, *dataset, context);
  if (!evaluation.ok()) return ReportError(evaluation.status());
  ReportOptions report;
  report.load_scan = LoadScan;
  const absl::StatusOr<std::string> warning = WriteReport(*evaluation, *dataset, arguments.out, report);
  if (!warning.ok()) return ReportError(warning.status());
  if (!warning->empty()) ReportWarning(*warning);
  if (arguments.json) return PrintResult(EvaluationJson(*evaluation) + "\n");
  return PrintResult(absl::StrCat(EvaluationText(*evaluation), "report       ", arguments.out, "/report.html\n"));
}

}  // namespace

Command AddEvaluateCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command =
      app.AddCommand("evaluate", "Evaluate methods on a data set with ground truth and write a report");
  command.AddOption("DATASET", arguments->dataset, "Folder of scans with poses.txt or pairs.txt").Required();
  command.AddOption("--method", arguments->methods, absl::StrCat("Methods, separated by commas: ", MethodNames()))
      .ShowDefault()
      .ValueName("A[,B...]");
  command.AddOption("--mode", arguments->mode, "Evaluate pairs one by one, or the whole drive")
      .OneOf({"pairs", "traverse"})
      .ShowDefault();
  command.AddOption("--every", arguments->selection.every, "With poses.txt: register scan i+N onto scan i")
      .Within(1, 1000000)
      .ShowDefault();
  command.AddOption("--take", arguments->selection.take, "Register only every N-th pair, for slow methods")
      .Within(1, 1000000)
      .ShowDefault();
  command
      .AddOption("--min-overlap", arguments->selection.min_overlap,
                 "With pairs.txt: skip pairs whose known overlap is below this")
      .Within(0.0, 1.0)
      .ShowDefault();
  command.AddOption("--seed", arguments->seed, "The same seed gives the same results")
      .Check(CheckNotNegative)
      .ShowDefault();
  command.AddOption("--threads", arguments->threads, "Maximum number of threads; 0: one per processor")
      .Within(0, 4096)
      .ShowDefault();
  command.AddOption("--time-budget", arguments->time_budget_s, "Seconds for each registration").Check(CheckSeconds);
  command
      .AddOption("--out", arguments->out,
                 "Folder for report.html, report.json (of a traverse: traverse.json), figures, trajectories and maps")
      .Required()
      .ValueName("DIR");
  command.AddFlag("--json", arguments->json, "Print one JSON object and nothing else");
  AddServerOptions(command, arguments->server);
  command.SetFooter(kExamples);
  return {.syntax = command, .run = [arguments](const CliContext& context) { return Run(*arguments, context); }};
}

}  // namespace curvereg::cli
