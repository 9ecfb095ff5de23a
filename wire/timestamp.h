// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Nanoseconds since 1970-01-01 UTC to and from google.protobuf.Timestamp.
#ifndef CURVEREG_WIRE_TIMESTAMP_H_
#define CURVEREG_WIRE_TIMESTAMP_H_

#include <chrono>
#include <cstdint>
#include <optional>

#include "google/protobuf/timestamp.pb.h"

namespace curvereg::wire {

int64_t NanosecondsOf(std::chrono::system_clock::time_point time);

google::protobuf::Timestamp TimestampOf(int64_t nanoseconds);
google::protobuf::Timestamp TimestampOf(std::chrono::system_clock::time_point time);

// Nullopt: beyond what 64 bits hold (292 years around 1970), or parts beyond their ranges.
std::optional<int64_t> NanosecondsOf(const google::protobuf::Timestamp& time);

std::chrono::system_clock::time_point TimePointOf(int64_t nanoseconds);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_TIMESTAMP_H_
