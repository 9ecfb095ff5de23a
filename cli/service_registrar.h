// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Registers through the service what an evaluation hands over, scan by scan.
#ifndef CURVEREG_CLI_SERVICE_REGISTRAR_H_
#define CURVEREG_CLI_SERVICE_REGISTRAR_H_

#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "cli/service_access.h"

namespace curvereg::cli {

// A server gets each scan once, losslessly, and is then asked by name; the scans that it did not have before are
// deleted at the end. In this process scans are handed over as they are.
class ServiceRegistrar {
 public:
  explicit ServiceRegistrar(ServiceAccess& service) : service_(service) {}

  absl::StatusOr<RegistrationResult> Register(const Scan& source, const Scan& target,
                                              const RegistrationOptions& options);

 private:
  absl::StatusOr<ScanReference> Offer(const Scan& scan, const RegistrationOptions& options);

  ServiceAccess& service_;
  std::map<std::string, std::string> name_of_;  // by ScanDigest
};

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_SERVICE_REGISTRAR_H_
