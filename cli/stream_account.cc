// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stream_account.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/cli_context.h"
#include "cli/traverse_text.h"
#include "files/json.h"
#include "files/result_json.h"

namespace curvereg::cli {
namespace {

std::string ResultText(const ScanResult& result, bool is_first, bool json) {
  if (json) return JsonText(ScanResultJson(result)) + "\n";
  return absl::StrCat(is_first ? ScanResultHeader() : "", ScanResultRow(result));
}

}  // namespace

void PrintScanResult(const ScanResult& result, bool json, StreamAccount& account) {
  const std::lock_guard lock(account.mutex);
  const bool is_first = account.num_results++ == 0;
  const bool is_begin = result.sequence_number == 0 && result.pose.origin == PoseOrigin::kSegmentStart;
  if (!is_begin && result.pose.origin != PoseOrigin::kRegistered) ++account.num_unregistered;
  if (!account.printed_all) return;
  account.printed_all = PrintResult(ResultText(result, is_first, json)) == ExitCode::kDone;
}

Json StreamSummaryJson(const RemoteTraverse& traverse, const StreamAccount& account,
                       const std::optional<OptimizationOutcome>& optimized) {
  Json json = TraverseJson(traverse);
  json["num_sent"] = account.progress.num_acknowledged;
  json["num_results"] = account.num_results;
  json["num_unregistered"] = account.num_unregistered;
  json["bytes_sent"] = account.progress.bytes_sent;
  json["bytes_resent"] = account.progress.bytes_resent;
  json["num_resumes"] = account.progress.num_resumes;
  json["optimization"] = optimized ? OptimizationJson(*optimized) : Json(nullptr);
  return {{"summary", std::move(json)}};
}

std::string StreamSummaryText(const RemoteTraverse& traverse, const StreamAccount& account,
                              const std::optional<OptimizationOutcome>& optimized) {
  return absl::StrCat(traverse.name, ": ", account.progress.num_acknowledged, " scans sent, ",
                      traverse.num_registered_scans, " registered in all, ", traverse.num_segments, " segments, ",
                      absl::StrFormat("%.2f m\n", traverse.path_length_m),
                      optimized ? OptimizationText(*optimized) : "");
}

}  // namespace curvereg::cli
