// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Unfinished uploads of a store: a file and a row for each, and in memory what is going on with it.
#ifndef CURVEREG_SERVER_STORE_UPLOAD_TABLE_H_
#define CURVEREG_SERVER_STORE_UPLOAD_TABLE_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/removal_marks.h"
#include "server/store/scan_catalog.h"
#include "server/store/scan_store.h"
#include "server/store/store_file.h"
#include "server/store/store_space.h"
#include "wire/digest.h"

namespace curvereg::server {

// One upload, as all its writers see it. Everything is guarded by `mutex`.
struct Upload {
  std::mutex mutex;
  UploadDescription description;
  uint64_t committed_offset = 0;
  std::chrono::system_clock::time_point last_progress;
  uint64_t writer_epoch = 0;  // of the writer that may go on
  bool has_ended = false;     // committed, discarded or expired
  // Of the first `digested_bytes`: behind the committed offset only for bytes that an earlier process took.
  std::unique_ptr<wire::Digester> digester;
  uint64_t digested_bytes = 0;
};

class UploadTable {
 public:
  // Locks are taken in the order Upload::mutex, then the table's own.
  UploadTable(std::string folder, const ScanStoreOptions& options, ScanCatalog& catalog, const RemovalMarks& removals,
              StoreSpace& space);

  // Moves the file at `path` to the orphaned files, under `name`.
  using SetAside = std::function<absl::Status(const std::string& path, const std::string& name)>;
  // Takes over what an earlier process left. A file that no row names is removed when it is empty, marked or one of
  // `stored`, the payloads with another name; else it is set aside.
  absl::Status Load(const std::set<FileIdentity>& stored, const SetAside& set_aside);
  // Of the files of all uploads.
  std::set<FileIdentity> Files() const;
  // Ids of uploads that were taken over without their bytes.
  const std::vector<std::string>& emptied() const { return emptied_; }

  // The right to write: valid while the upload goes on and its epoch is `epoch`.
  struct Grant {
    std::shared_ptr<Upload> upload;
    uint64_t epoch = 0;
    uint64_t committed_offset = 0;  // when it was granted
    StoreFile file;
  };
  // Begins or resumes, see ScanStore::BeginUpload.
  absl::StatusOr<Grant> Begin(const UploadDescription& description);
  absl::StatusOr<UploadState> State(const std::string& upload_id);
  absl::StatusOr<int> Expire(std::chrono::system_clock::time_point now);

  // Precondition for the three: upload.mutex is held.
  void AddProgress(Upload& upload, uint64_t bytes);
  // Forgets the upload, whose row is gone already, and removes its file.
  void End(Upload& upload);
  // Forgets row and upload.
  void Drop(Upload& upload);

  std::string PathOf(const std::string& upload_id) const { return folder_ + "/" + upload_id; }
  uint64_t num_uploads() const;

 private:
  void Forget(Upload& upload);
  absl::Status Adopt(const UploadDescription& description);
  std::shared_ptr<Upload> Find(const std::string& upload_id) const;
  absl::StatusOr<Grant> Resume(const std::shared_ptr<Upload>& upload, const UploadDescription& description);
  absl::StatusOr<Grant> BeginNew(const UploadDescription& description);
  absl::Status Admit(const std::shared_ptr<Upload>& upload);

  const std::string folder_;
  const ScanStoreOptions options_;
  ScanCatalog& catalog_;
  const RemovalMarks& removals_;
  StoreSpace& space_;
  std::vector<std::string> emptied_;  // by Load
  mutable std::mutex mutex_;          // guards uploads_
  std::map<std::string, std::shared_ptr<Upload>> uploads_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_UPLOAD_TABLE_H_
