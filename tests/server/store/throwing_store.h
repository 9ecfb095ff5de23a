// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A store whose reads throw, as a library does that gets no memory. All else is the real store's.
#ifndef CURVEREG_TESTS_SERVER_STORE_THROWING_STORE_H_
#define CURVEREG_TESTS_SERVER_STORE_THROWING_STORE_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "server/store/scan_store.h"

namespace curvereg::server {

class ThrowingStore final : public ScanStore {
 public:
  explicit ThrowingStore(ScanStore& store) : store_(store) {}
  absl::StatusOr<std::unique_ptr<UploadWriter>> BeginUpload(const UploadDescription& description) override {
    return store_.BeginUpload(description);
  }
  absl::StatusOr<UploadState> GetUpload(const std::string& upload_id) override { return store_.GetUpload(upload_id); }
  absl::StatusOr<int> ExpireUploads(std::chrono::system_clock::time_point now) override {
    return store_.ExpireUploads(now);
  }
  absl::StatusOr<std::optional<StoredScan>> FindScan(const UploadDescription& description) override {
    return store_.FindScan(description);
  }
  absl::StatusOr<StoredScan> GetScan(const std::string& scan_id) override {
    if (throws_early) throw std::bad_alloc();
    return store_.GetScan(scan_id);
  }
  absl::StatusOr<std::string> ReadPayload(const std::string&, uint64_t, uint64_t) override { throw std::bad_alloc(); }
  absl::StatusOr<std::string> ReadWholePayload(const std::string&) override { throw std::bad_alloc(); }
  absl::Status CheckScan(const std::string&) override { throw std::bad_alloc(); }
  absl::StatusOr<ScanPage> ListScans(int page_size, const std::string& page_token) override {
    return store_.ListScans(page_size, page_token);
  }
  absl::Status DeleteScan(const std::string& scan_id) override { return store_.DeleteScan(scan_id); }
  absl::Status WithReservedSpace(const std::function<absl::Status()>& work) override {
    return store_.WithReservedSpace(work);
  }
  StoreStatistics Statistics() override { return store_.Statistics(); }
  std::vector<std::string> DamagedScans() override { return store_.DamagedScans(); }
  RecoveryReport Recovery() override { return store_.Recovery(); }

  bool throws_early = false;

 private:
  ScanStore& store_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_TESTS_SERVER_STORE_THROWING_STORE_H_
