// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Bytes of the caller's that gRPC reads where they lie.
#ifndef CURVEREG_CLIENT_LENT_BYTES_H_
#define CURVEREG_CLIENT_LENT_BYTES_H_

#include <grpcpp/support/slice.h>

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string_view>

namespace curvereg::internal {

// Counts the slices that are out, for gRPC may hold one longer than its call: until the socket has taken it or the
// connection has died.
class LentBytes {
 public:
  LentBytes() = default;
  ~LentBytes() { AwaitReturn(); }
  LentBytes(const LentBytes&) = delete;
  LentBytes& operator=(const LentBytes&) = delete;

  // Refers to `bytes`, which must stay until AwaitReturn.
  grpc::Slice Lend(std::string_view bytes) {
    {
      const std::lock_guard lock(mutex_);
      ++num_out_;
    }
    // gRPC takes a pointer to non-const and does not write through it.
    return grpc::Slice(const_cast<char*>(bytes.data()), bytes.size(), &LentBytes::Return, this);
  }
  // Blocks until nobody refers to the bytes any more.
  void AwaitReturn() {
    std::unique_lock lock(mutex_);
    all_back_.wait(lock, [this] { return num_out_ == 0; });
  }

 private:
  static void Return(void* lender) {
    auto& self = *static_cast<LentBytes*>(lender);
    const std::lock_guard lock(self.mutex_);
    // With the lock held: whoever waits may destroy us next.
    if (--self.num_out_ == 0) self.all_back_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable all_back_;
  int64_t num_out_ = 0;
};

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_LENT_BYTES_H_
