// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/cloud_arguments.h"

#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/progress_bar.h"
#include "files/cloud_file.h"
#include "wire/resource_names.h"

namespace curvereg::cli {

absl::StatusOr<Scan> ReadCloudArgument(const std::string& path, const CliContext& context) {
  ProgressBar bar("reading " + std::filesystem::path(path).filename().string());
  CloudReadOptions options;
  options.progress = [&](double share) { bar.Update(share); };
  absl::StatusOr<Scan> scan = ReadCloudFile(path, options);
  if (absl::IsNotFound(scan.status()) && path.starts_with(wire::kScanPrefix)) {
    return absl::NotFoundError(
        absl::StrCat(scan.status().message(),
                     " (the name of a scan on a server is scans/ and 32 hexadecimal digits, with --server)"));
  }
  if (context.interrupted.stop_requested()) return absl::CancelledError("interrupted");
  return scan;
}

absl::StatusOr<Scan> ReadScanArgument(const std::string& path, const CliContext& context) {
  absl::StatusOr<Scan> scan = ReadCloudArgument(path, context);
  if (!scan.ok()) return scan;
  const absl::Status valid = ValidateScan(*scan);
  if (!valid.ok()) return absl::Status(valid.code(), absl::StrCat(path, ": ", valid.message()));
  return scan;
}

bool IsSameFile(const std::string& a, const std::string& b) {
  std::error_code error;
  return std::filesystem::equivalent(a, b, error) && !error;
}

}  // namespace curvereg::cli
