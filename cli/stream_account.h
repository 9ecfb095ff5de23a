// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Output of `stream`: a line for each result, and a summary.
#ifndef CURVEREG_CLI_STREAM_ACCOUNT_H_
#define CURVEREG_CLI_STREAM_ACCOUNT_H_

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "client/traverses.h"
#include "files/json.h"

namespace curvereg::cli {

// Results so far, reported by the thread of the streamer.
struct StreamAccount {
  mutable std::mutex mutex;  // guards the rest while a streamer is there
  uint64_t num_results = 0;
  uint64_t num_unregistered = 0;  // beyond the first scan of the traverse
  bool printed_all = true;
  uint64_t num_scans = 0;  // to be sent; 0: unknown
  StreamProgress progress;
};

// Counts the result and prints its line, the first one below a header. Once a line could not be printed, which it says,
// none is: scans are safe on the server whether somebody reads of them or not.
void PrintScanResult(const ScanResult& result, bool json, StreamAccount& account);

Json StreamSummaryJson(const RemoteTraverse& traverse, const StreamAccount& account,
                       const std::optional<OptimizationOutcome>& optimized);
std::string StreamSummaryText(const RemoteTraverse& traverse, const StreamAccount& account,
                              const std::optional<OptimizationOutcome>& optimized);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_STREAM_ACCOUNT_H_
