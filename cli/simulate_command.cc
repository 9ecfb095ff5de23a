// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulate_command.h"

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/argument_parsing.h"
#include "cli/progress_bar.h"
#include "cli/service_access.h"
#include "cli/simulated_dataset.h"
#include "core/base/parallel.h"
#include "files/cloud_file.h"
#include "files/json.h"
#include "program/command_syntax.h"
#include "sim/presets.h"
#include "sim/simulation.h"

namespace curvereg::cli {
namespace {

// An option that changes one value of the preset, and only when it is given.
using Change = std::function<void(sim::SimulationOptions&)>;

struct Arguments {
  std::string preset = "mars-yard-sim";
  std::string terrain;
  std::string out;
  int threads = 0;
  bool json = false;
  std::vector<Change> changes;
  ServerArguments server;
};

std::string Footer() {
  std::string text = "Presets:\n";
  for (const sim::Preset& preset : sim::Presets()) {
    absl::StrAppendFormat(&text, "  %-15s %s\n", std::string(preset.name), std::string(preset.description));
  }
  return text + R"(
Writes a data set: scans 0000.pcd, 0001.pcd, ... in the sensor frame and the ground truth, poses.txt (TUM, sensor
to world) or, for pairs that do not overlap, negatives.txt. The same options and seed give the same bytes at any number of threads.

With --server the scans are uploaded as well.

Exit status: 0 done, 1 internal error or interrupted, 2 wrong arguments or output that cannot be written, 4 server
unreachable or refused the call.

Examples:
  curvereg simulate --out yard
  curvereg simulate --preset mars-dome --seed 7 --out dome
  curvereg simulate --preset gale --terrain mars_gale_hirise_1m.asc --scans 10 --out gale)";
}

std::string PresetList() {
  std::string names;
  for (const sim::Preset& preset : sim::Presets()) {
    absl::StrAppend(&names, names.empty() ? "" : ", ", std::string(preset.name));
  }
  return names;
}

// The elevation model that comes with the test data, where there is one.
std::string DefaultTerrain() {
  const char* folder = std::getenv("CURVEREG_TEST_DATA");
  if (folder == nullptr) return "";
  std::string path = absl::StrCat(folder, "/terrain/mars_gale_hirise_1m.asc");
  return std::filesystem::exists(path) ? path : "";
}

absl::StatusOr<sim::SimulationOptions> OptionsOf(const Arguments& arguments) {
  std::optional<sim::SimulationOptions> options = sim::PresetOptions(arguments.preset);
  if (!options.has_value()) {
    return absl::InvalidArgumentError(absl::StrCat("unknown preset '", arguments.preset, "'; presets: ", PresetList()));
  }
  if (arguments.preset == "strangers") {
    ReportWarning(
        "the preset 'strangers' is called negatives now; the old name will not be accepted in the next release");
  }
  for (const Change& change : arguments.changes) change(*options);
  if (!arguments.terrain.empty()) {
    options->world.kind = sim::WorldKind::kElevationModel;
    options->world.elevation.path = arguments.terrain;
  } else if (options->world.kind == sim::WorldKind::kElevationModel) {
    options->world.elevation.path = DefaultTerrain();
    if (options->world.elevation.path.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(
          "the preset '", arguments.preset,
          "' needs an elevation model: give --terrain FILE (ESRI ASCII grid), or set CURVEREG_TEST_DATA to a folder "
          "that contains terrain/mars_gale_hirise_1m.asc"));
    }
  }
  return *options;
}

std::string SummaryText(const sim::Simulation& simulation, const SimulatedDatasetSummary& summary) {
  std::string text = absl::StrFormat("scans        %d, %d points on average\n", simulation.num_scans(),
                                     summary.num_points / simulation.num_scans());
  if (simulation.options().separate_worlds) {
    return text + absl::StrFormat("pairs        %d that share no ground\n", simulation.NegativePairs().size());
  }
  return text +
         absl::StrFormat("steps        %.2f m, %.3f rad on average\n", summary.mean_step_m, summary.mean_rotation_rad);
}

std::string SummaryJson(const Arguments& arguments, const sim::Simulation& simulation,
                        const SimulatedDatasetSummary& summary) {
  const Json json = {{"preset", arguments.preset},
                     {"seed", simulation.options().seed},
                     {"folder", arguments.out},
                     {"uploaded_to", arguments.server.server},
                     {"scans", simulation.num_scans()},
                     {"points", summary.num_points},
                     {"negatives", simulation.NegativePairs().size()},
                     {"mean_step_m", summary.mean_step_m},
                     {"mean_rotation_rad", summary.mean_rotation_rad}};
  return JsonText(json) + "\n";
}

// The files as they were written, so that the server has what a reader of the folder has.
absl::Status UploadDataset(const Arguments& arguments, int num_scans, const CliContext& context) {
  absl::StatusOr<ServiceAccess> service = ServiceAccess::Open(arguments.server, context);
  if (!service.ok()) return service.status();
  ProgressBar bar("uploading");
  for (int i = 0; i < num_scans; ++i) {
    const absl::StatusOr<Scan> scan = ReadCloudFile(absl::StrCat(arguments.out, "/", SimulatedScanName(i), ".pcd"));
    if (!scan.ok()) return scan.status();
    const absl::StatusOr<UploadOutcome> outcome = service->client().UploadScan(*scan, LosslessTransfer(context));
    if (!outcome.ok()) return outcome.status();
    bar.Update(static_cast<double>(i + 1) / num_scans, outcome->scan.name);
  }
  return absl::OkStatus();
}

ExitCode Run(const Arguments& arguments, const CliContext& context) {
  const absl::StatusOr<sim::SimulationOptions> options = OptionsOf(arguments);
  if (!options.ok()) return ReportError(options.status());
  std::optional<absl::StatusOr<sim::Simulation>> simulation;
  WithThreadLimit(arguments.threads, [&] { simulation = sim::Simulation::Create(*options); });
  if (!simulation->ok()) return ReportError(simulation->status());
  const sim::Simulation& scans = **simulation;
  const absl::Status folder = PrepareOutputFolder(arguments.out);
  if (!folder.ok()) return ReportError(folder);

  absl::StatusOr<SimulatedDatasetSummary> summary;
  {
    ProgressBar bar("simulating");
    const auto progress = [&](int done) {
      bar.Update(static_cast<double>(done) / scans.num_scans(), absl::StrCat(done, "/", scans.num_scans()));
    };
    summary = WriteSimulatedDataset(
        scans, arguments.out,
        {.num_threads = arguments.threads, .cancellation = context.interrupted, .progress = progress});
  }
  if (!summary.ok()) return ReportError(summary.status());
  if (!arguments.server.server.empty()) {
    const absl::Status uploaded = UploadDataset(arguments, scans.num_scans(), context);
    if (!uploaded.ok()) return ReportError(uploaded);
  }
  if (arguments.json) return PrintResult(SummaryJson(arguments, scans, *summary));
  const std::string& server = arguments.server.server;
  return PrintResult(SummaryText(scans, *summary) + (server.empty() ? "" : "uploaded     to " + server + "\n"));
}

// Declares an option whose value is put into the preset's options by `set`. Ranges are Validate()'s to check.
template <typename T>
OptionSyntax AddChange(CommandSyntax command, Arguments* arguments, const std::string& name_and_help,
                       void (*set)(sim::SimulationOptions&, T)) {
  const std::size_t space = name_and_help.find(' ');
  return command.AddSetter<T>(
      name_and_help.substr(0, space),
      [arguments, set](const T& value) {
        arguments->changes.push_back([set, value](sim::SimulationOptions& options) { set(options, value); });
      },
      name_and_help.substr(space + 1));
}

using Options = sim::SimulationOptions;

void AddDriveChanges(CommandSyntax command, Arguments* arguments) {
  AddChange<uint64_t>(command, arguments, "--seed The same seed gives the same bytes",
                      [](Options& options, uint64_t value) { options.seed = value; })
      .Check(CheckNotNegative);
  AddChange<int>(command, arguments, "--scans Number of scans",
                 [](Options& options, int value) { options.num_scans = value; });
  AddChange<double>(command, arguments, "--step Distance driven between scans [m]",
                    [](Options& options, double value) { options.traverse.step_m = value; });
  AddChange<double>(command, arguments, "--relief Factor applied to the heights of ground and rocks",
                    [](Options& options, double value) { options.world.relief = value; });
  AddChange<double>(command, arguments, "--rocks Rocks per square metre", [](Options& options, double value) {
    options.world.yard.rocks.density_per_m2 = value;
    options.world.dome.rocks.density_per_m2 = value;
    options.world.elevation.rocks.density_per_m2 = value;
  });
  AddChange<double>(command, arguments, "--mast Height of the sensor above the ground [m]",
                    [](Options& options, double value) { options.rover.mast_m = value; });
}

void AddScannerChanges(CommandSyntax command, Arguments* arguments) {
  AddChange<int>(command, arguments, "--columns Number of beams in azimuth",
                 [](Options& options, int value) { options.scanner.pattern.columns = value; });
  AddChange<int>(command, arguments, "--rows Number of beams in elevation (spiral: turns)",
                 [](Options& options, int value) { options.scanner.pattern.rows = value; });
  AddChange<double>(command, arguments, "--max-range Maximum range [m]",
                    [](Options& options, double value) { options.scanner.max_range_m = value; });
  AddChange<double>(command, arguments, "--noise Standard deviation of the range noise [m]",
                    [](Options& options, double value) { options.scanner.noise_m = value; });
  AddChange<double>(command, arguments, "--jitter Standard deviation of a beam's direction [rad]",
                    [](Options& options, double value) { options.scanner.beam_jitter_rad = value; });
  AddChange<double>(command, arguments, "--keep Fraction of beams that are kept",
                    [](Options& options, double value) { options.scanner.keep_fraction = value; });
  AddChange<double>(command, arguments, "--dropout Fraction of returns that are lost",
                    [](Options& options, double value) { options.scanner.dropout_fraction = value; });
  AddChange<double>(command, arguments, "--outliers Fraction of returns with a wrong range",
                    [](Options& options, double value) { options.scanner.outlier_fraction = value; });
  AddChange<double>(command, arguments, "--speed Forward speed during a scan [m/s]",
                    [](Options& options, double value) { options.scanner.motion.forward_mps = value; });
}

void AddPattern(CommandSyntax command, Arguments* arguments) {
  const auto set = [arguments](const std::string& name) {
    const sim::PatternKind kind = name == "spiral"    ? sim::PatternKind::kSpiral
                                  : name == "rosette" ? sim::PatternKind::kRosette
                                                      : sim::PatternKind::kRegular;
    arguments->changes.push_back([kind](Options& options) { options.scanner.pattern.kind = kind; });
  };
  command.AddSetter<std::string>("--pattern", set, "Scan pattern: regular, spiral or rosette")
      .OneOf({"regular", "spiral", "rosette"});
}

}  // namespace

Command AddSimulateCommand(CommandSyntax app) {
  auto arguments = std::make_shared<Arguments>();
  CommandSyntax command =
      app.AddCommand("simulate", "Simulate scans of a rover in a simulated world, with ground truth");
  command.AddOption("--out", arguments->out, "Folder for the scans and the ground truth").Required().ValueName("DIR");
  command.AddOption("--preset", arguments->preset, "What to simulate, see below").ShowDefault().ValueName("NAME");
  command.AddOption("--terrain", arguments->terrain, "Elevation model to drive on (ESRI ASCII grid)").ValueName("FILE");
  AddDriveChanges(command, arguments.get());
  AddPattern(command, arguments.get());
  AddScannerChanges(command, arguments.get());
  command.AddOption("--threads", arguments->threads, "Maximum number of threads; 0: one per processor")
      .Within(0, 4096)
      .ShowDefault();
  command.AddFlag("--json", arguments->json, "Print one JSON object and nothing else");
  AddServerOptions(command, arguments->server);
  command.SetFooter(Footer());
  return {.syntax = command, .run = [arguments](const CliContext& context) { return Run(*arguments, context); }};
}

}  // namespace curvereg::cli
