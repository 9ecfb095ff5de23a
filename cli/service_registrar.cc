// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/service_registrar.h"

namespace curvereg::cli {

absl::StatusOr<ScanReference> ServiceRegistrar::Offer(const Scan& scan, const RegistrationOptions& options) {
  if (!service_.is_remote()) return ScanReference(std::cref(scan));
  const std::string digest = ScanDigest(scan);
  if (const auto found = name_of_.find(digest); found != name_of_.end()) return ScanReference(found->second);
  const absl::StatusOr<UploadOutcome> outcome =
      service_.client().UploadScan(scan, LosslessTransfer({.interrupted = options.cancellation}));
  if (!outcome.ok()) return outcome.status();
  if (!outcome->already_stored) service_.DeleteAtEnd(outcome->scan.name);
  name_of_[digest] = outcome->scan.name;
  return ScanReference(outcome->scan.name);
}

absl::StatusOr<RegistrationResult> ServiceRegistrar::Register(const Scan& source, const Scan& target,
                                                              const RegistrationOptions& options) {
  const absl::StatusOr<ScanReference> source_reference = Offer(source, options);
  if (!source_reference.ok()) return source_reference.status();
  const absl::StatusOr<ScanReference> target_reference = Offer(target, options);
  if (!target_reference.ok()) return target_reference.status();
  return service_.client().RegisterScans(*source_reference, *target_reference, options, kInlineEncoding);
}

}  // namespace curvereg::cli
