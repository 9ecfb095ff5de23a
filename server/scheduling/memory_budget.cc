// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scheduling/memory_budget.h"

#include <chrono>
#include <string>

#include "absl/strings/str_cat.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

// Memory comes back when a registration ends, and those take tens to hundreds of milliseconds.
constexpr std::chrono::milliseconds kRetryDelay{250};

constexpr uint64_t kBytesPerScan = uint64_t{24} << 20;
constexpr uint64_t kBytesOfPictures = uint64_t{192} << 20;
constexpr uint64_t kBytesPerPoint = 512;

}  // namespace

uint64_t PreparationBytes(uint64_t num_points) { return kBytesPerScan + kBytesPerPoint * num_points; }

uint64_t RenderingBytes(uint64_t num_points) { return kBytesOfPictures + kBytesPerPoint * num_points; }

MemoryBudget::Reservation::~Reservation() {
  if (budget_ != nullptr) budget_->reserved_bytes_.fetch_sub(bytes_);
}

absl::StatusOr<MemoryBudget::Reservation> MemoryBudget::Reserve(uint64_t bytes) {
  if (bytes > total_bytes_) {
    return wire::MakeError(v1::ERROR_REASON_SCAN_TOO_LARGE, "needs more memory than the server may ever use",
                           {{"limit", absl::StrCat(total_bytes_)}, {"value", absl::StrCat(bytes)}});
  }
  uint64_t reserved = reserved_bytes_.load();
  do {
    if (reserved > total_bytes_ - bytes) {
      return wire::WithRetryDelay(
          wire::MakeError(v1::ERROR_REASON_MEMORY_BUDGET, "the memory for accepted work is reserved"), kRetryDelay);
    }
  } while (!reserved_bytes_.compare_exchange_weak(reserved, reserved + bytes));
  Reservation reservation;
  reservation.budget_ = this;
  reservation.bytes_ = bytes;
  return reservation;
}

}  // namespace curvereg::server
