// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/timestamp.h"

#include <limits>

namespace curvereg::wire {
namespace {

constexpr int64_t kNanosPerSecond = 1'000'000'000;
// Most seconds whose nanoseconds fit 64 bits, one less for the fraction.
constexpr int64_t kMaxSeconds = std::numeric_limits<int64_t>::max() / kNanosPerSecond - 1;

}  // namespace

int64_t NanosecondsOf(std::chrono::system_clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

google::protobuf::Timestamp TimestampOf(int64_t nanoseconds) {
  google::protobuf::Timestamp time;
  int64_t seconds = nanoseconds / kNanosPerSecond;
  if (nanoseconds % kNanosPerSecond < 0) --seconds;
  time.set_seconds(seconds);
  time.set_nanos(static_cast<int32_t>(nanoseconds - seconds * kNanosPerSecond));
  return time;
}

google::protobuf::Timestamp TimestampOf(std::chrono::system_clock::time_point time) {
  return TimestampOf(NanosecondsOf(time));
}

std::optional<int64_t> NanosecondsOf(const google::protobuf::Timestamp& time) {
  if (time.seconds() > kMaxSeconds || time.seconds() < -kMaxSeconds) return std::nullopt;
  if (time.nanos() < 0 || time.nanos() >= kNanosPerSecond) return std::nullopt;
  return time.seconds() * kNanosPerSecond + time.nanos();
}

std::chrono::system_clock::time_point TimePointOf(int64_t nanoseconds) {
  return std::chrono::system_clock::time_point(
      std::chrono::duration_cast<std::chrono::system_clock::duration>(std::chrono::nanoseconds(nanoseconds)));
}

}  // namespace curvereg::wire
