// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What an upload stream does with its messages, apart from the streaming: checks, store, decoding. Runs on the disk
// pool.
#ifndef CURVEREG_SERVER_SCANS_UPLOAD_SESSION_H_
#define CURVEREG_SERVER_SCANS_UPLOAD_SESSION_H_

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <unordered_map>

#include "absl/status/statusor.h"
#include "core/scan/scan.h"
#include "curvereg/v1/scan_service.pb.h"
#include "server/operations/metrics.h"
#include "server/scans/upload_message.h"
#include "server/scheduling/memory_budget.h"
#include "server/settings/server_config.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

// Which stream has which upload, so that the one that loses it ends at once and not only at its next chunk.
class UploadOwners {
 public:
  // Runs `begin` while no other stream can begin the same upload; when it succeeds, `owner` has the upload and the one
  // that had it before is requested to stop.
  absl::Status TakeOver(const std::string& upload_id, const std::stop_source& owner,
                        const std::function<absl::Status()>& begin);
  // Forgets it, unless somebody else has it by now.
  void Release(const std::string& upload_id, const std::stop_source& owner);

 private:
  // By hash of the id: held during `begin`, so that the store and we agree about who came last.
  std::array<std::mutex, 64> begin_mutexes_;
  std::mutex mutex_;
  std::unordered_map<std::string, std::stop_source> owners_;
};

// What sessions share. All outlive them.
struct UploadEnvironment {
  LimitsConfig limits;
  MemoryBudget* memory = nullptr;
  ScanStore* store = nullptr;
  Metrics* metrics = nullptr;
  UploadOwners* owners = nullptr;
};

class UploadSession {
 public:
  // `replaced` is requested to stop when another session takes the upload over.
  UploadSession(const UploadEnvironment& environment, std::stop_source replaced)
      : environment_(environment), replaced_(std::move(replaced)) {}
  ~UploadSession();
  UploadSession(const UploadSession&) = delete;
  UploadSession& operator=(const UploadSession&) = delete;

  // Does what the message asks and returns the answer: ready, progress, or done, after which there is nothing more to
  // do. Errors as the contract has them; what is committed then stays, except where the payload as a whole is wrong
  // (DIGEST_MISMATCH, MALFORMED_PAYLOAD): that upload is forgotten. One thread at a time.
  absl::StatusOr<v1::UploadScanResponse> Handle(UploadMessage& message);

 private:
  absl::StatusOr<v1::UploadScanResponse> Start(v1::UploadScanStart& start);
  absl::StatusOr<v1::UploadScanResponse> Append(const UploadMessage& message);
  absl::Status Store(std::span<const std::string_view> pieces);
  absl::Status StoreBlock(std::span<const std::string_view> pieces);
  absl::StatusOr<v1::UploadScanResponse> Finish(const v1::UploadScanFinish& finish);
  absl::StatusOr<std::optional<StoredScan>> FindKnown() const;
  absl::StatusOr<v1::UploadScanResponse> DecodeAndCommit(const v1::Digest& declared);
  absl::StatusOr<v1::UploadScanResponse> Commit(uint64_t finite_point_count, const std::string& content_digest);
  absl::Status CheckDigest(const v1::Digest& declared, const v1::Digest& actual);
  absl::Status OffsetError(std::string_view message) const;

  const UploadEnvironment& environment_;
  const std::stop_source replaced_;
  UploadDescription description_;         // as `start` told it; id empty before
  std::unique_ptr<UploadWriter> writer_;  // from `start` on
  // In all bytes so far, where they are points as the core has them and all came in this stream: then nothing needs to
  // be read again and decoded at the end.
  std::optional<FinitePointCounter> finite_points_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_UPLOAD_SESSION_H_
