// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The scans that `stream` sends: files of a folder, with time and prior from an odometry file.
#ifndef CURVEREG_CLI_SCAN_SOURCE_H_
#define CURVEREG_CLI_SCAN_SOURCE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/cli_context.h"
#include "cli/scan_folder.h"
#include "client/traverses.h"
#include "files/trajectory_file.h"
#include "program/command_syntax.h"

namespace curvereg::cli {

struct ScanSourceArguments {
  std::string folder, follow;  // one of the two
  double idle_end_s = 0.0;     // 0: never
  std::string priors;          // empty: none
  std::string prior_sigma;     // empty: unknown
};

// Declares DIR, --follow, --idle-end, --priors, --prior-sigma.
void AddScanSourceOptions(CommandSyntax command, ScanSourceArguments& arguments);

class ScanSource {
 public:
  // Looks at all but the scans themselves. INVALID_ARGUMENT: not one folder, an empty one, priors without a pose for
  // each scan or with times that do not grow; errors of reading them.
  static absl::StatusOr<ScanSource> Open(const ScanSourceArguments& arguments);

  // Passes over the first `num_sent` files; before Next. INVALID_ARGUMENT: there are fewer.
  absl::Status GoOnAfter(uint64_t num_sent);

  // The next scan; nullopt: there are no more, or a watched folder is watched no longer. CANCELLED once interrupted.
  absl::StatusOr<std::optional<StreamedScan>> Next(const CliContext& context);
  // Of those still to come; 0: unknown.
  uint64_t num_left() const { return growing_ ? 0 : files_.size() - next_; }
  bool is_endless() const { return growing_.has_value(); }
  int num_late() const { return growing_ ? growing_->num_late() : 0; }

 private:
  ScanSource() = default;
  absl::Status ReadPriors(const ScanSourceArguments& arguments);
  absl::StatusOr<std::string> NextFile(const CliContext& context);
  void AddTimeAndPrior(StreamedScan& scan) const;

  std::string folder_;
  std::vector<std::string> files_;        // of a folder that does not grow
  std::optional<GrowingFolder> growing_;  // of one that does
  uint64_t num_passed_over_ = 0;          // of the growing folder's files, so far
  uint64_t next_ = 0;                     // sequence number
  std::vector<StampedPose> odometry_;
  bool has_times_ = false;
  std::optional<Matrix6d> covariance_;
  uint64_t num_sent_ = 0;
};

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_SCAN_SOURCE_H_
