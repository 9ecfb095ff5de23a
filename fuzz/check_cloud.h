// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What must hold of a cloud reader's answer whatever the bytes were.
#ifndef CURVEREG_FUZZ_CHECK_CLOUD_H_
#define CURVEREG_FUZZ_CHECK_CLOUD_H_

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "absl/status/statusor.h"
#include "files/cloud_file.h"

namespace curvereg {

inline constexpr int64_t kFuzzMaxPoints = 100'000;

inline CloudReadOptions FuzzOptions() {
  CloudReadOptions options;
  options.max_points = kFuzzMaxPoints;
  return options;
}

inline std::string_view AsText(const uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// Ends the process when an error has no message or no code of the readers, or a cloud has more points than bytes or
// than the limit.
inline void CheckCloud(const absl::Status& status, const Scan* scan, std::size_t num_bytes) {
  if (scan != nullptr) {
    if (std::ssize(scan->points) > kFuzzMaxPoints || scan->points.size() > num_bytes) std::abort();
    return;
  }
  const bool is_known =
      absl::IsInvalidArgument(status) || absl::IsDataLoss(status) || absl::IsResourceExhausted(status);
  if (!is_known || status.message().empty()) std::abort();
}

}  // namespace curvereg

#endif  // CURVEREG_FUZZ_CHECK_CLOUD_H_
