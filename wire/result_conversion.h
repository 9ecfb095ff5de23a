// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Results of a registration to and from the contract's messages. Errors as in geometry_conversion.h.
#ifndef CURVEREG_WIRE_RESULT_CONVERSION_H_
#define CURVEREG_WIRE_RESULT_CONVERSION_H_

#include "absl/status/statusor.h"
#include "core/methods/registration_result.h"
#include "curvereg/v1/registration.pb.h"

namespace curvereg::wire {

v1::RegistrationResult ToWire(const RegistrationResult& result);
// The client's side; the server is not trusted either.
absl::StatusOr<RegistrationResult> FromWire(const v1::RegistrationResult& result);

// At most 200 encoded bytes, whatever the result.
v1::RegistrationSummary ToSummary(const RegistrationResult& result);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_RESULT_CONVERSION_H_
