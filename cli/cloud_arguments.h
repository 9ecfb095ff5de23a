// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Clouds named on the command line.
#ifndef CURVEREG_CLI_CLOUD_ARGUMENTS_H_
#define CURVEREG_CLI_CLOUD_ARGUMENTS_H_

#include <string>

#include "absl/status/statusor.h"
#include "cli/cli_context.h"
#include "core/scan/scan.h"

namespace curvereg::cli {

// ReadCloudFile with a progress bar. CANCELLED once interrupted.
absl::StatusOr<Scan> ReadCloudArgument(const std::string& path, const CliContext& context);

// The same, and checks that the scan can take part in a registration (ValidateScan); its errors are given the file
// name.
absl::StatusOr<Scan> ReadScanArgument(const std::string& path, const CliContext& context);

// True when both name the same file, by whatever path.
bool IsSameFile(const std::string& a, const std::string& b);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_CLOUD_ARGUMENTS_H_
