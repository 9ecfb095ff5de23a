// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A scan that is to be registered, stored or inline in a request, from the check of its header to its points.
#ifndef CURVEREG_SERVER_PREPARATION_REGISTRATION_INPUT_H_
#define CURVEREG_SERVER_PREPARATION_REGISTRATION_INPUT_H_

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "core/methods/prepared_scan.h"
#include "core/scan/scan.h"
#include "curvereg/v1/registration_service.pb.h"
#include "server/preparation/scan_sources.h"

namespace curvereg::server {

class RegistrationInput {
 public:
  // Checks what can be checked without the points. `field`: of the request, for errors; `input` and `sources` outlive
  // the result. INVALID_FIELD, SCAN_TOO_LARGE; of stored scans SCAN_NOT_FOUND and errors of the store.
  static absl::StatusOr<RegistrationInput> Find(const v1::ScanInput& input, const std::string& field,
                                                const ScanSources& sources);
  // The same for the stored scan of this id.
  static absl::StatusOr<RegistrationInput> OfStored(const std::string& scan_id, const std::string& field,
                                                    const ScanSources& sources);

  uint64_t num_points() const;
  // What decoding takes at most; nothing when it is prepared already.
  uint64_t DecodingBytes() const;
  // What decoding, preparing and registering it takes at most. Little when it is prepared already.
  uint64_t MemoryBytes() const { return DecodingBytes() + PreparationBytes(cached_ == nullptr ? num_points() : 0); }

  bool is_stored() const { return inline_scan_ == nullptr; }

  // The points; those of the prepared scan when there is one. MALFORMED_PAYLOAD, STORED_SCAN_DAMAGED.
  absl::StatusOr<std::shared_ptr<const Scan>> Decode() const;

  // Prepared, and kept for other calls when it is stored. Errors of Decode; UNUSABLE_SCAN naming the field; CANCELLED,
  // DEADLINE_EXCEEDED. Uses the threads of the innermost WithThreadLimit.
  absl::StatusOr<std::shared_ptr<const PreparedScan>> Prepare(const Stop& stop) const;

  // After the prepared scan was used: it may have grown.
  void UpdateCache() const;

  // The same error as UNUSABLE_SCAN naming the field, if it is one of the core's about the scan; others unchanged.
  absl::Status Named(const absl::Status& status) const;

 private:
  RegistrationInput(std::string field, const ScanSources& sources) : sources_(&sources), field_(std::move(field)) {}
  const v1::PointCloudHeader& header() const;  // precondition: not prepared
  absl::Status FindStored();
  absl::Status CheckInline() const;
  absl::StatusOr<std::unique_ptr<const PreparedScan>> DecodeAndPrepare(const Stop& stop) const;

  const ScanSources* sources_;
  std::string field_;
  const v1::PointCloud* inline_scan_ = nullptr;  // null: stored
  std::string id_;                               // stored
  uint64_t payload_bytes_ = 0;                   // to be read from the store
  v1::PointCloudHeader header_;                  // stored and not prepared
  std::shared_ptr<const PreparedScan> cached_;   // stored and prepared
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_PREPARATION_REGISTRATION_INPUT_H_
