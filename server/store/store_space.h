// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// How full a store is.
#ifndef CURVEREG_SERVER_STORE_STORE_SPACE_H_
#define CURVEREG_SERVER_STORE_STORE_SPACE_H_

#include <cstdint>
#include <mutex>

namespace curvereg::server {

// Safe to use from several threads.
class StoreSpace {
 public:
  explicit StoreSpace(uint64_t max_bytes) : max_bytes_(max_bytes) {}

  // Sets the declared bytes of an upload aside; false when they do not fit.
  bool Reserve(uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    const uint64_t used = payload_bytes_ + reserved_bytes_;
    if (used > max_bytes_ || bytes > max_bytes_ - used) return false;
    reserved_bytes_ += bytes;
    return true;
  }
  // The same, fit or not: what is on disk already.
  void Adopt(uint64_t reserved, uint64_t uploaded) {
    const std::lock_guard lock(mutex_);
    reserved_bytes_ += reserved;
    uploaded_bytes_ += uploaded;
  }
  void AddUploaded(uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    uploaded_bytes_ += bytes;
  }
  // An upload ends.
  void Release(uint64_t reserved, uint64_t uploaded) {
    const std::lock_guard lock(mutex_);
    reserved_bytes_ -= reserved;
    uploaded_bytes_ -= uploaded;
  }
  void AddScan() {
    const std::lock_guard lock(mutex_);
    ++num_scans_;
  }
  void RemoveScan() {
    const std::lock_guard lock(mutex_);
    --num_scans_;
  }
  // Scans may share one.
  void AddPayload(uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    payload_bytes_ += bytes;
  }
  void RemovePayload(uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    payload_bytes_ -= bytes;
  }
  uint64_t num_scans() const {
    const std::lock_guard lock(mutex_);
    return num_scans_;
  }
  uint64_t StoredBytes() const {
    const std::lock_guard lock(mutex_);
    return payload_bytes_ + uploaded_bytes_;
  }

 private:
  const uint64_t max_bytes_;
  mutable std::mutex mutex_;
  uint64_t num_scans_ = 0;
  uint64_t payload_bytes_ = 0;
  uint64_t reserved_bytes_ = 0;  // declared by the unfinished uploads
  uint64_t uploaded_bytes_ = 0;  // what came of them
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_STORE_SPACE_H_
