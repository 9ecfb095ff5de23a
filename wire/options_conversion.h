// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Methods and options of a registration to and from the contract's messages. Errors as in geometry_conversion.h.
#ifndef CURVEREG_WIRE_OPTIONS_CONVERSION_H_
#define CURVEREG_WIRE_OPTIONS_CONVERSION_H_

#include <cstdint>

#include "absl/status/statusor.h"
#include "core/methods/registration_options.h"
#include "curvereg/v1/registration.pb.h"

namespace curvereg::wire {

v1::Method ToWire(Method method);
absl::StatusOr<Method> FromWire(v1::Method method);  // UNSPECIFIED: curvelet

// Threads for a request that wants at most so many; 0 on either side: no bound from there.
int ThreadsWithin(uint32_t wanted, int max_threads);

v1::RegistrationOptions ToWire(const RegistrationOptions& options);  // limits, deadline and cancellation stay behind
// max_threads above `max_threads` are cut to it (0: no bound). cancellation and deadline are left for the caller.
absl::StatusOr<RegistrationOptions> FromWire(const v1::RegistrationOptions& options, int max_threads);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_OPTIONS_CONVERSION_H_
