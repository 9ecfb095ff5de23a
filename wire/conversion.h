// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The core's structs to and from the contract's messages. What comes from the wire is validated here and nowhere
// trusted: errors are INVALID_FIELD and name the field relative to the message given.
#ifndef CURVEREG_WIRE_CONVERSION_H_
#define CURVEREG_WIRE_CONVERSION_H_

#include "absl/status/statusor.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"
#include "curvereg/v1/geometry.pb.h"
#include "curvereg/v1/registration.pb.h"

namespace curvereg::wire {

v1::RigidTransform ToWire(const RigidTransform& T);
absl::StatusOr<RigidTransform> FromWire(const v1::RigidTransform& T);

v1::PoseCovariance ToWire(const Matrix6d& covariance);
// Of 21 finite numbers.
absl::StatusOr<Matrix6d> SymmetricFromWire(const v1::PoseCovariance& covariance);
// The same; positive definite.
absl::StatusOr<Matrix6d> FromWire(const v1::PoseCovariance& covariance);

v1::Method ToWire(Method method);
absl::StatusOr<Method> FromWire(v1::Method method);  // UNSPECIFIED: curvelet

// Threads for a request that wants at most so many; 0 on either side: no bound from there.
int ThreadsWithin(uint32_t wanted, int max_threads);

v1::RegistrationOptions ToWire(const RegistrationOptions& options);  // limits, deadline and cancellation stay behind
// max_threads above `max_threads` are cut to it (0: no bound). cancellation and deadline are left for the caller.
absl::StatusOr<RegistrationOptions> FromWire(const v1::RegistrationOptions& options, int max_threads);

v1::RegistrationResult ToWire(const RegistrationResult& result);
// The client's side; the server is not trusted either.
absl::StatusOr<RegistrationResult> FromWire(const v1::RegistrationResult& result);

// At most 200 encoded bytes, whatever the result.
v1::RegistrationSummary ToSummary(const RegistrationResult& result);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_CONVERSION_H_
