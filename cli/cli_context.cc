// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/cli_context.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "client/client.h"

namespace curvereg::cli {
namespace fs = std::filesystem;

namespace {

// Errors of a server about the arguments are usage errors; its other errors are refusals.
ExitCode ExitCodeForServerError(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kUnimplemented:
      return ExitCode::kUsage;
    case absl::StatusCode::kCancelled:
    case absl::StatusCode::kInternal:
      return ExitCode::kInternal;
    default:
      return ExitCode::kUnreachable;
  }
}

}  // namespace

ExitCode ExitCodeFor(const absl::Status& status) {
  if (!ErrorReasonName(status).empty()) return ExitCodeForServerError(status);
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return ExitCode::kDone;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kAlreadyExists:
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kResourceExhausted:  // too many points, no space left on the device
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kUnimplemented:
    case absl::StatusCode::kDataLoss:
      return ExitCode::kUsage;
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kUnauthenticated:
    case absl::StatusCode::kDeadlineExceeded:
      return ExitCode::kUnreachable;
    default:
      return ExitCode::kInternal;
  }
}

ExitCode ReportError(const absl::Status& status, const std::string& advice) {
  std::string message = status.message().empty() ? status.ToString() : std::string(status.message());
  if (absl::IsCancelled(status))
    message = "interrupted";  // only the user cancels; the library's message addresses programs
  std::fprintf(stderr, "curvereg: %s%s%s\n", message.c_str(), advice.empty() ? "" : "; ", advice.c_str());
  return ExitCodeFor(status);
}

void ReportWarning(const std::string& message) { std::fprintf(stderr, "curvereg: warning: %s\n", message.c_str()); }

ExitCode PrintResult(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (written) return ExitCode::kDone;
  // Without the result on standard output the command has failed for its caller.
  return ReportError(absl::ResourceExhaustedError("standard output: the result could not be written"));
}

absl::Status PrepareOutputFolder(const std::string& path) {
  if (path.empty()) return absl::InvalidArgumentError("the name of the output folder is empty");
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is a file; the output needs a folder"));
  }
  fs::create_directories(path, error);
  if (error) return absl::InvalidArgumentError(absl::StrCat(path, ": cannot create the folder: ", error.message()));
  if (access(path.c_str(), W_OK | X_OK) != 0) {
    return absl::PermissionDeniedError(absl::StrCat(path, ": no permission to write into this folder"));
  }
  return absl::OkStatus();
}

absl::Status CheckOutputFile(const std::string& path) {
  std::error_code error;
  if (path.empty()) return absl::InvalidArgumentError("the name of the output file is empty");
  if (fs::is_directory(path, error)) return absl::InvalidArgumentError(absl::StrCat(path, ": is a folder, not a file"));
  const fs::path parent = fs::absolute(path, error).parent_path();
  if (!fs::is_directory(parent, error)) {
    return absl::NotFoundError(absl::StrCat(path, ": its folder does not exist"));
  }
  if (access(parent.c_str(), W_OK | X_OK) != 0) {
    return absl::PermissionDeniedError(absl::StrCat(path, ": no permission to write into its folder"));
  }
  return absl::OkStatus();
}

}  // namespace curvereg::cli
