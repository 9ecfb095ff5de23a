// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The evidence of a result, which result_conversion.h carries along.
#ifndef CURVEREG_WIRE_EVIDENCE_CONVERSION_H_
#define CURVEREG_WIRE_EVIDENCE_CONVERSION_H_

#include "absl/status/statusor.h"
#include "core/methods/registration_result.h"
#include "curvereg/v1/registration.pb.h"

namespace curvereg::wire {

// Measures that were not computed, and any that are not a number, are absent.
v1::Evidence ToWire(const Evidence& evidence);

// INVALID_FIELD: a count that no scan can have, a measure outside its range.
absl::StatusOr<Evidence> FromWire(const v1::Evidence& evidence);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_EVIDENCE_CONVERSION_H_
