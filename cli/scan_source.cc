// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/scan_source.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/argument_parsing.h"
#include "cli/cloud_arguments.h"
#include "files/scan_files.h"
#include "program/command_syntax.h"

namespace curvereg::cli {
namespace {

// KITTI files have no times; their reader gives the number of the line.
bool HasTimes(const std::vector<StampedPose>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (poses[i].timestamp_s != static_cast<double>(i)) return true;
  }
  return false;
}

// Times become whole nanoseconds of 64 bits, and a drive's scans come one after the other.
absl::Status CheckTimes(const std::vector<StampedPose>& poses) {
  constexpr double kMaxSeconds = 9e9;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double time_s = poses[i].timestamp_s;
    if (!(std::abs(time_s) < kMaxSeconds)) {
      return absl::InvalidArgumentError(
          absl::StrCat("the time of pose ", i + 1, ", ", time_s, ", is not a time in seconds since 1970"));
    }
    if (i > 0 && time_s <= poses[i - 1].timestamp_s) {
      return absl::InvalidArgumentError(absl::StrCat("the time of pose ", i + 1, " is not after that of pose ", i,
                                                     "; expected one pose per scan, in the order of the scans"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

void AddScanSourceOptions(CommandSyntax command, ScanSourceArguments& arguments) {
  OptionSyntax folder = command.AddOption("DIR", arguments.folder, "Folder of scans, sent in name order");
  command.AddOption("--follow", arguments.follow, "Folder that grows: sends each new scan, until ^C or --idle-end")
      .Excludes(folder)
      .ValueName("DIR");
  command.AddOption("--idle-end", arguments.idle_end_s, "With --follow: end after so many seconds without a new scan")
      .Check(CheckSeconds)
      .ValueName("S");
  command
      .AddOption("--priors", arguments.priors,
                 "Odometry of the drive, TUM or KITTI: one pose per scan, in the order of the scans. TUM times become "
                 "the times of the scans")
      .ValueName("FILE");
  command.AddOption("--prior-sigma", arguments.prior_sigma,
                    "Standard deviations of the motion from scan to scan: ROTATION_RAD,TRANSLATION_M");
}

absl::StatusOr<ScanSource> ScanSource::Open(const ScanSourceArguments& arguments) {
  ScanSource source;
  if (arguments.folder.empty() == arguments.follow.empty()) {
    return absl::InvalidArgumentError("no scans given: expected a folder DIR, or --follow DIR");
  }
  if (!arguments.follow.empty()) {
    GrowingFolder::Options options;
    options.except = arguments.priors;
    if (arguments.idle_end_s > 0.0) {
      options.idle_end = std::chrono::milliseconds(static_cast<int64_t>(std::ceil(arguments.idle_end_s * 1e3)));
    }
    source.growing_.emplace(arguments.follow, options);
  } else if (arguments.idle_end_s > 0.0) {
    return absl::InvalidArgumentError("--idle-end needs --follow");
  }
  source.folder_ = source.growing_ ? arguments.follow : arguments.folder;
  absl::StatusOr<std::vector<std::string>> files = ScanFilesIn(source.folder_, arguments.priors);
  if (!files.ok()) return files.status();
  if (!source.growing_) {
    if (files->empty()) return absl::InvalidArgumentError(absl::StrCat(source.folder_, ": contains no scans"));
    source.files_ = *std::move(files);
  }
  if (absl::Status status = source.ReadPriors(arguments); !status.ok()) return status;
  return source;
}

absl::Status ScanSource::GoOnAfter(uint64_t num_sent) {
  if (!growing_ && files_.size() < num_sent) {
    return absl::InvalidArgumentError(
        absl::StrCat(folder_, ": contains ", files_.size(), " scans, but the traverse already has ", num_sent));
  }
  next_ = num_sent_ = num_sent;
  return absl::OkStatus();
}

absl::Status ScanSource::ReadPriors(const ScanSourceArguments& arguments) {
  if (arguments.priors.empty()) {
    return arguments.prior_sigma.empty() ? absl::OkStatus()
                                         : absl::InvalidArgumentError("--prior-sigma needs --priors");
  }
  absl::StatusOr<std::vector<StampedPose>> poses = ReadTrajectoryFile(arguments.priors);
  if (!poses.ok()) return poses.status();
  if (!growing_ && poses->size() != files_.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat(arguments.priors, ": has ", poses->size(), " poses for ", files_.size(), " scans"));
  }
  odometry_ = *std::move(poses);
  has_times_ = HasTimes(odometry_);
  if (const absl::Status times = CheckTimes(odometry_); !times.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(arguments.priors, ": ", times.message()));
  }
  if (arguments.prior_sigma.empty()) return absl::OkStatus();
  const absl::StatusOr<Matrix6d> covariance = ParsePriorSigma(arguments.prior_sigma);
  if (!covariance.ok()) return covariance.status();
  covariance_ = *covariance;
  return absl::OkStatus();
}

absl::StatusOr<std::string> ScanSource::NextFile(const CliContext& context) {
  if (!growing_) return next_ < files_.size() ? files_[next_] : std::string();
  for (; num_passed_over_ < num_sent_; ++num_passed_over_) {
    absl::StatusOr<std::string> sent = growing_->Next(context.interrupted);
    if (!sent.ok() || sent->empty()) return sent;
  }
  return growing_->Next(context.interrupted);
}

absl::StatusOr<std::optional<StreamedScan>> ScanSource::Next(const CliContext& context) {
  if (!growing_ && context.interrupted.stop_requested()) return absl::CancelledError("interrupted");
  const absl::StatusOr<std::string> file = NextFile(context);
  if (!file.ok()) return file.status();
  if (file->empty()) return std::nullopt;
  // A file that was found before the interruption is sent.
  absl::StatusOr<Scan> cloud = ReadScanArgument(*file, growing_ ? CliContext() : context);
  if (!cloud.ok()) return cloud.status();
  StreamedScan scan;
  scan.sequence_number = next_++;
  scan.scan = *std::move(cloud);
  AddTimeAndPrior(scan);
  return scan;
}

void ScanSource::AddTimeAndPrior(StreamedScan& scan) const {
  const uint64_t i = scan.sequence_number;
  if (i >= odometry_.size()) return;
  if (has_times_) scan.time_ns = std::llround(odometry_[i].timestamp_s * 1e9);
  if (i == 0) return;
  scan.prior = Prior{.T_target_source = odometry_[i - 1].T_world_scan.inverse() * odometry_[i].T_world_scan,
                     .covariance = covariance_};
}

}  // namespace curvereg::cli
