// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Rigid transforms and pose covariances to and from the contract's messages. What comes from the wire is validated here
// and nowhere trusted: errors are INVALID_FIELD and name the field relative to the message given.
#ifndef CURVEREG_WIRE_GEOMETRY_CONVERSION_H_
#define CURVEREG_WIRE_GEOMETRY_CONVERSION_H_

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"
#include "curvereg/v1/geometry.pb.h"

namespace curvereg::wire {

v1::RigidTransform ToWire(const RigidTransform& T);
absl::StatusOr<RigidTransform> FromWire(const v1::RigidTransform& T);

v1::PoseCovariance ToWire(const Matrix6d& covariance);
// Of 21 finite numbers.
absl::StatusOr<Matrix6d> SymmetricFromWire(const v1::PoseCovariance& covariance);
// The same; positive definite.
absl::StatusOr<Matrix6d> FromWire(const v1::PoseCovariance& covariance);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_GEOMETRY_CONVERSION_H_
