// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Memory is reserved before work is accepted, by points and bytes, and given back when the work is done.
#ifndef CURVEREG_SERVER_SCHEDULING_MEMORY_BUDGET_H_
#define CURVEREG_SERVER_SCHEDULING_MEMORY_BUDGET_H_

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include "absl/status/statusor.h"

namespace curvereg::server {

class MemoryBudget {
 public:
  // Gives back what it holds when destroyed. Must not outlive the budget.
  class Reservation {
   public:
    Reservation() = default;
    Reservation(Reservation&& other) noexcept { *this = std::move(other); }
    Reservation& operator=(Reservation&& other) noexcept {
      std::swap(budget_, other.budget_);
      std::swap(bytes_, other.bytes_);
      return *this;
    }
    ~Reservation();
    uint64_t bytes() const { return bytes_; }

   private:
    friend class MemoryBudget;
    MemoryBudget* budget_ = nullptr;
    uint64_t bytes_ = 0;
  };

  explicit MemoryBudget(uint64_t total_bytes) : total_bytes_(total_bytes) {}

  // MEMORY_BUDGET with a RetryInfo when it does not fit now, SCAN_TOO_LARGE when it never would.
  absl::StatusOr<Reservation> Reserve(uint64_t bytes);

  uint64_t total_bytes() const { return total_bytes_; }
  uint64_t reserved_bytes() const { return reserved_bytes_.load(); }

 private:
  const uint64_t total_bytes_;
  std::atomic<uint64_t> reserved_bytes_ = 0;
};

// What preparing a scan of this many points and registering it takes at most, its points apart, by any method, while
// the other scan is prepared at the same time. Measured: up to 22 MB a scan and 530 bytes a point, where every point
// lies in a cell of its own; scans of surfaces take a tenth of the latter. The test holds it to be enough.
uint64_t PreparationBytes(uint64_t num_points);

// The same for drawing and encoding all its pictures.
uint64_t RenderingBytes(uint64_t num_points);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCHEDULING_MEMORY_BUDGET_H_
