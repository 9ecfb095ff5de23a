// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stream_command.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "cli/argument_parsing.h"
#include "cli/cloud_arguments.h"
#include "cli/progress_bar.h"
#include "cli/scan_folder.h"
#include "cli/scan_source.h"
#include "cli/stream_account.h"
#include "cli/traverse_arguments.h"
#include "client/traverses.h"
#include "core/methods/registration_names.h"
#include "program/command_syntax.h"

namespace curvereg::cli {
namespace {

struct Arguments {
  TraverseArguments traverse;
  ScanSourceArguments source;
  double rate_hz = 0.0;
  bool resume = false;
  std::string method;  // empty: the traverse's, or of a new one the default
  std::string encoding = "quantized";
  double max_error_m = 1e-3;
  std::string frame_id;
  bool optimize = false;
};

constexpr char kNotes[] =
    R"(Sends the scans in name order; the first file of the folder is scan 0 of the traverse. Resumes after connection
loss: what the server acknowledged is not sent again. With --follow the folder is watched for new files, until ^C or
--idle-end; write files under another name and rename them when they are complete.

With --json it prints one line per result and a last line with a summary.

Exit status: 0 done and every scan registered, 1 internal error or interrupted, 2 wrong arguments or input, 3 done, but
at least one scan was not registered (its pose is extrapolated with the prior, or it starts a new segment), 4 server
unreachable or refused the call.

Examples:
  curvereg stream sol-12 --traverse sol-12 --server ground-station:50051
  curvereg stream --follow incoming --traverse sol-12 --resume --priors odometry.txt --prior-sigma 0.02,0.3)";

StreamOptions OptionsOf(const Arguments& arguments, StreamAccount& account, ProgressBar& bar) {
  StreamOptions options;
  options.encoding = {
      .kind = arguments.encoding == "lossless" ? TransferEncoding::Kind::kLossless : TransferEncoding::Kind::kQuantized,
      .max_error_m = arguments.max_error_m};
  options.on_result = [&arguments, &account](const ScanResult& result) {
    PrintScanResult(result, arguments.traverse.json, account);
  };
  options.on_progress = [&account, &bar](const StreamProgress& progress) {
    const std::lock_guard lock(account.mutex);
    account.progress = progress;
    const double share =
        static_cast<double>(progress.num_acknowledged) / static_cast<double>(std::max<uint64_t>(account.num_scans, 1));
    bar.Update(share, absl::StrCat(
                          progress.num_acknowledged, " scans acknowledged, ", progress.num_results, " registered",
                          progress.num_resumes == 0 ? "" : absl::StrCat(", resumed ", progress.num_resumes, " times")));
  };
  return options;
}

absl::StatusOr<TraverseSettings> SettingsOf(const Arguments& arguments) {
  TraverseSettings settings;
  if (arguments.method.empty()) return settings;
  const absl::StatusOr<Method> method = ParseMethod(arguments.method);
  if (!method.ok()) return method.status();
  settings.registration.method = *method;
  return settings;
}

// The traverse to go on with or to begin.
absl::StatusOr<RemoteTraverse> BeginTraverse(TraverseClient& client, const Arguments& arguments,
                                             const TraverseSettings& settings, const CliContext& context) {
  const std::string name = TraverseName(arguments.traverse.id);
  if (arguments.resume) {
    absl::StatusOr<RemoteTraverse> found = client.Get(name, context.UntilInterrupted());
    if (found.ok() && !arguments.method.empty() &&
        found->settings.registration.method != settings.registration.method) {
      ReportWarning(absl::StrCat(name, ": keeps the method it was created with, ",
                                 std::string(MethodName(found->settings.registration.method))));
    }
    if (!absl::IsNotFound(found.status())) return found;
  }
  absl::StatusOr<RemoteTraverse> traverse =
      client.Create(name.substr(name.find('/') + 1), settings, context.UntilInterrupted());
  if (absl::IsAlreadyExists(traverse.status())) {
    return absl::AlreadyExistsError(absl::StrCat(
        traverse.status().message(), "; choose another name, or continue it with --resume, which keeps its settings"));
  }
  if (!traverse.ok() || traverse->next_sequence_number == 0) return traverse;
  return absl::AlreadyExistsError(
      absl::StrCat(name, ": already has ", traverse->next_sequence_number, " scans; --resume continues after them"));
}

// Waits so that scans go out no faster than asked for.
class Clockwork {
 public:
  explicit Clockwork(double rate_hz) : period_(rate_hz > 0.0 ? 1.0 / rate_hz : 0.0) {}
  void Wait(const std::stop_token& stop) {
    const auto now = std::chrono::steady_clock::now();
    next_ = std::max(next_, now);
    SleepOrStop(std::chrono::ceil<std::chrono::milliseconds>(next_ - now), stop);
    next_ += std::chrono::duration_cast<std::chrono::nanoseconds>(period_);
  }

 private:
  std::chrono::duration<double> period_;
  std::chrono::time_point<std::chrono::steady_clock, std::chrono::nanoseconds> next_{};
};

absl::Status SendAll(ScanStreamer& streamer, ScanSource& source, const Arguments& arguments,
                     const CliContext& context) {
  Clockwork clockwork(arguments.rate_hz);
  while (true) {
    absl::StatusOr<std::optional<StreamedScan>> scan = source.Next(context);
    if (!scan.ok()) return scan.status();
    if (!scan->has_value()) return absl::OkStatus();
    clockwork.Wait(context.interrupted);
    (*scan)->frame_id = arguments.frame_id;
    if (absl::Status sent = streamer.Send(**std::move(scan)); !sent.ok()) return sent;
  }
}

struct Stream {
  const Arguments& arguments;
  TraverseClient& client;
  const RemoteTraverse& traverse;
  ScanSource& source;
};

absl::Status Run(const Stream& stream, StreamAccount& account, const CliContext& context) {
  const auto& [arguments, client, traverse, source] = stream;
  if (const absl::Status found = source.GoOnAfter(traverse.next_sequence_number); !found.ok()) return found;
  account.num_scans = source.num_left();
  ProgressBar bar("streaming");
  StreamOptions options = OptionsOf(arguments, account, bar);
  if (traverse.num_registered_scans > 0) options.last_result = traverse.num_registered_scans - 1;
  // ^C ends a watched folder, not what was found in it.
  if (!source.is_endless()) options.cancellation = context.interrupted;
  absl::StatusOr<std::unique_ptr<ScanStreamer>> streamer = client.Stream(traverse.name, options);
  if (!streamer.ok()) return streamer.status();
  // A watched folder may be silent for long after the server has gone.
  std::stop_source over;
  const std::stop_callback interrupt(context.interrupted, [&over] { over.request_stop(); });
  const std::stop_callback end((*streamer)->ended(), [&over] { over.request_stop(); });
  const absl::Status sent = SendAll(**streamer, source, arguments, {.interrupted = over.get_token()});
  if (source.num_late() > 0) {
    ReportWarning(
        absl::StrCat(source.num_late(), " files were skipped: they appeared after files with later names were sent"));
  }
  // Even after an error of a file: the scans before it count.
  const absl::Status finished = (*streamer)->Finish();
  const std::lock_guard lock(account.mutex);
  account.progress = (*streamer)->progress();
  return sent.ok() || !finished.ok() ? finished : sent;
}

// After all scans: what was asked for in the end, and the summary.
ExitCode Finish(const Arguments& arguments, TraverseClient& client, const std::string& name,
                const StreamAccount& account, const CliContext& context) {
  // ^C is how a watched folder ends, and what comes after is still to be done.
  const Stop until = arguments.source.follow.empty() ? context.UntilInterrupted() : Stop();
  std::optional<OptimizationOutcome> optimized;
  if (arguments.optimize) {
    const absl::StatusOr<OptimizationOutcome> outcome = client.Optimize(name, true, until.cancellation);
    if (!outcome.ok()) return ReportError(outcome.status());
    optimized = *outcome;
  }
  const absl::StatusOr<RemoteTraverse> traverse = client.Get(name, until);
  if (!traverse.ok()) return ReportError(traverse.status());
  if (!account.printed_all) return ExitCode::kUsage;  // said already
  const ExitCode printed = PrintAnswer(arguments.traverse, StreamSummaryJson(*traverse, account, optimized),
                                       StreamSummaryText(*traverse, account, optimized));
  if (printed != ExitCode::kDone) return printed;
  return account.num_unregistered == 0 ? ExitCode::kDone : ExitCode::kRejected;
}

// Why a stream ended early, and what to do.
ExitCode ReportEarlyEnd(const absl::Status& error, TraverseClient& client, const std::string& name,
                        const StreamAccount& account) {
  // Whoever deletes a traverse takes it over first.
  const bool may_be_gone = absl::IsAborted(error) || absl::IsNotFound(error);
  const bool was_deleted = may_be_gone && absl::IsNotFound(client.Get(name).status());
  if (was_deleted) return ReportError(absl::NotFoundError(absl::StrCat(name, ": was deleted during the stream")));
  const uint64_t num_safe = account.progress.num_acknowledged;
  return ReportError(error,
                     num_safe == 0 ? "" : absl::StrCat(num_safe, " scans are stored; --resume continues after them"));
}

ExitCode Run(const Arguments& arguments, const CliContext& context) {
  // A mistake must not leave a traverse behind.
  const absl::StatusOr<TraverseSettings> settings = SettingsOf(arguments);
  if (!settings.ok()) return ReportError(settings.status());
  absl::StatusOr<ScanSource> source = ScanSource::Open(arguments.source);
  if (!source.ok()) return ReportError(source.status());
  absl::StatusOr<ServiceAccess> service = OpenTraverses(arguments.traverse, DataFolder::kMayBegin, context);
  if (!service.ok()) return ReportError(service.status());
  TraverseClient& client = service->client().traverses();
  const absl::StatusOr<RemoteTraverse> begun = BeginTraverse(client, arguments, *settings, context);
  if (!begun.ok()) return ReportError(begun.status());
  StreamAccount account;
  const absl::Status streamed = Run(Stream{arguments, client, *begun, *source}, account, context);
  if (!streamed.ok()) return ReportEarlyEnd(streamed, client, begun->name, account);
  return Finish(arguments, client, begun->name, account, context);
}

}  // namespace

Command AddStreamCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command = app.AddCommand("stream", "Stream a folder of scans to a traverse");
  AddScanSourceOptions(command, arguments->source);
  command.AddOption("--traverse", arguments->traverse.id, "Name of the traverse; created if it does not exist")
      .Required()
      .ValueName("ID");
  command.AddOption("--rate", arguments->rate_hz, "Maximum number of scans per second")
      .Check(CheckPositive)
      .ValueName("HZ");
  command.AddFlag("--resume", arguments->resume, "Continue after the scans that the traverse already has");
  command.AddOption("--method", arguments->method, absl::StrCat("Method of a new traverse: ", MethodNames()))
      .ShowDefault("curvelet")
      .ValueName("NAME");
  command.AddOption("--encoding", arguments->encoding, "lossless (compressed) or quantized (smallest)")
      .OneOf({"lossless", "quantized"})
      .ShowDefault();
  command.AddOption("--max-error", arguments->max_error_m, "With quantized: maximum error of a point [m]")
      .Check(CheckPositive)
      .ShowDefault();
  command.AddOption("--frame", arguments->frame_id, "Name of the sensor frame, stored with the scans")
      .ValueName("NAME");
  command.AddFlag("--optimize", arguments->optimize, "At the end search for loop closures and optimise all poses");
  AddTraverseOptions(command, arguments->traverse, "Print one JSON object a line and nothing else");
  command.SetFooter(kNotes);
  return {.syntax = command, .run = [arguments](const CliContext& context) { return Run(*arguments, context); }};
}

}  // namespace curvereg::cli
