// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// gRPC slices that refer to bytes of the caller instead of copying them.
#ifndef CURVEREG_CLIENT_BORROWED_SLICES_H_
#define CURVEREG_CLIENT_BORROWED_SLICES_H_

#include <grpcpp/support/slice.h>

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string_view>

namespace curvereg::internal {

// Counts the slices that gRPC still holds. It may hold one longer than its call: until the socket has taken it or the
// connection is closed.
class BorrowedSlices {
 public:
  BorrowedSlices() = default;
  ~BorrowedSlices() { AwaitRelease(); }
  BorrowedSlices(const BorrowedSlices&) = delete;
  BorrowedSlices& operator=(const BorrowedSlices&) = delete;

  // Refers to `bytes`, which must stay until AwaitRelease.
  grpc::Slice Borrow(std::string_view bytes) {
    {
      const std::lock_guard lock(mutex_);
      ++num_held_;
    }
    // gRPC takes a pointer to non-const and does not write through it.
    return grpc::Slice(const_cast<char*>(bytes.data()), bytes.size(), &BorrowedSlices::Release, this);
  }
  // Blocks until gRPC has released every slice.
  void AwaitRelease() {
    std::unique_lock lock(mutex_);
    all_released_.wait(lock, [this] { return num_held_ == 0; });
  }

 private:
  static void Release(void* owner) {
    auto& self = *static_cast<BorrowedSlices*>(owner);
    const std::lock_guard lock(self.mutex_);
    // With the lock held: a waiting thread may destroy this object next.
    if (--self.num_held_ == 0) self.all_released_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable all_released_;
  int64_t num_held_ = 0;
};

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_BORROWED_SLICES_H_
