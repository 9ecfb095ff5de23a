// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which stream has which upload, so that a stream that loses its upload ends at once and not only at its next chunk.
#ifndef CURVEREG_SERVER_SCANS_UPLOAD_OWNERS_H_
#define CURVEREG_SERVER_SCANS_UPLOAD_OWNERS_H_

#include <array>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <unordered_map>

#include "absl/status/status.h"

namespace curvereg::server {

// Safe to use from several threads.
class UploadOwners {
 public:
  // Runs `begin` while no other stream can begin the same upload. When it succeeds, `owner` has the upload, and the
  // stream that had it before is requested to stop. Returns what `begin` returns.
  absl::Status TakeOver(const std::string& upload_id, const std::stop_source& owner,
                        const std::function<absl::Status()>& begin);
  // Forgets the upload, unless another stream has it by now.
  void Release(const std::string& upload_id, const std::stop_source& owner);

 private:
  // By hash of the id: held during `begin`, so that the store and the owners agree about which stream came last.
  std::array<std::mutex, 64> begin_mutexes_;
  std::mutex mutex_;
  std::unordered_map<std::string, std::stop_source> owners_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_UPLOAD_OWNERS_H_
