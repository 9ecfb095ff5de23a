// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/duration.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace curvereg::wire {
namespace {

// The bounds that google/protobuf/duration.proto gives.
constexpr int64_t kMaxSeconds = 315'576'000'000;
constexpr int32_t kNanosPerSecond = 1'000'000'000;

}  // namespace

google::protobuf::Duration ToWire(double seconds) {
  google::protobuf::Duration duration;
  if (std::isnan(seconds)) return duration;
  const double bound = static_cast<double>(kMaxSeconds);
  const double bounded = std::clamp(seconds, -bound, bound);
  double whole = std::trunc(bounded);
  double nanos = std::round((bounded - whole) * kNanosPerSecond);
  if (std::abs(nanos) >= kNanosPerSecond) {  // rounded up to a full second
    whole += std::copysign(1.0, nanos);
    nanos = 0.0;
  }
  duration.set_seconds(static_cast<int64_t>(whole));
  duration.set_nanos(static_cast<int32_t>(nanos));
  return duration;
}

std::optional<double> SecondsOf(const google::protobuf::Duration& duration) {
  const int64_t seconds = duration.seconds();
  const int32_t nanos = duration.nanos();
  if (seconds < -kMaxSeconds || seconds > kMaxSeconds) return std::nullopt;
  if (nanos <= -kNanosPerSecond || nanos >= kNanosPerSecond) return std::nullopt;
  if ((seconds > 0 && nanos < 0) || (seconds < 0 && nanos > 0)) return std::nullopt;
  return static_cast<double>(seconds) + static_cast<double>(nanos) / kNanosPerSecond;
}

}  // namespace curvereg::wire
