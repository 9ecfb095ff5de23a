// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The report of one registration: result.json and report.html, a page that holds its pictures.
#ifndef CURVEREG_CLI_REGISTER_REPORT_H_
#define CURVEREG_CLI_REGISTER_REPORT_H_

#include <string>

#include "absl/status/status.h"
#include "core/methods/registration_result.h"
#include "core/scan/scan.h"

namespace curvereg::cli {

struct NamedScans {
  std::string source_name;  // as shown in the report
  std::string target_name;
  const Scan& source;
  const Scan& target;
};

// Precondition: the folder exists. Errors are those of writing a file.
absl::Status WriteRegisterReport(const std::string& folder, const NamedScans& scans, const RegistrationResult& result);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_REGISTER_REPORT_H_
