// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The scans of a folder that grows, in name order.
#ifndef CURVEREG_CLI_SCAN_FOLDER_H_
#define CURVEREG_CLI_SCAN_FOLDER_H_

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace curvereg::cli {

// Returns early once the stop is requested.
void SleepOrStop(std::chrono::milliseconds time, const std::stop_token& stop);

// Gives the files of a folder that others write into, one by one in name order. A file is given once its size has not
// changed for `settle_time`: whoever writes under another name and renames is on the safe side in any case.
class GrowingFolder {
 public:
  struct Options {
    std::chrono::milliseconds settle_time{500};
    std::optional<std::chrono::milliseconds> idle_end;  // ends when nothing new came for so long; absent: never
    std::string except = "";                            // a file that is no scan
  };
  GrowingFolder(std::string folder, const Options& options) : folder_(std::move(folder)), options_(options) {}

  // The next file; empty: the end, by idleness or by the stop. Files whose names come before one that was given are
  // too late and passed over; `num_late` counts them. Errors of ScanFilesIn.
  absl::StatusOr<std::string> Next(const std::stop_token& stop);
  int num_late() const { return num_late_; }

 private:
  struct Seen {
    uintmax_t size = 0;
    std::chrono::steady_clock::time_point since;
    bool given = false;
  };
  // The first file, if it has settled; looks at all of them.
  absl::StatusOr<std::string> Look();

  std::string folder_;
  Options options_;
  std::map<std::string, Seen> seen_;
  std::string last_given_;
  int num_late_ = 0;
};

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_SCAN_FOLDER_H_
