// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Seconds to and from google.protobuf.Duration.
#ifndef CURVEREG_WIRE_DURATION_H_
#define CURVEREG_WIRE_DURATION_H_

#include <optional>

#include "google/protobuf/duration.pb.h"

namespace curvereg::wire {

// To the nearest nanosecond; at most the 10,000 years that a Duration may hold. What is not a number becomes 0.
google::protobuf::Duration ToWire(double seconds);

// Nullopt: parts beyond their ranges or of different signs.
std::optional<double> SecondsOf(const google::protobuf::Duration& duration);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_DURATION_H_
