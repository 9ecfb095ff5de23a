// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The store's database: which scans and unfinished uploads there are. Safe to use from several threads; readers do not
// wait for changes to reach the disk.
#ifndef CURVEREG_SERVER_STORE_SCAN_CATALOG_H_
#define CURVEREG_SERVER_STORE_SCAN_CATALOG_H_

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/scan_store.h"
#include "server/store/sqlite_database.h"

namespace curvereg::server {

// A scan and its place in the order of storing; places are never used again.
struct CatalogedScan {
  int64_t sequence = 0;
  StoredScan scan;
};

class ScanCatalog {
 public:
  // Checks an existing database; makes the tables, or brings those of an older version up to date. `may_be_new`: the
  // store has no payloads, so an empty database is a new one. DATA_LOSS: damaged, or empty where it may not be;
  // FAILED_PRECONDITION: made by a newer version, or a file system that cannot keep a log; messages name the file and
  // tell what to do. Others: cannot be read or written.
  static absl::StatusOr<std::unique_ptr<ScanCatalog>> Open(const std::string& path, bool may_be_new);

  // Adds the scan and drops the upload that brought it, on disk when done.
  absl::Status AddScan(const StoredScan& scan, const std::string& upload_id);
  absl::Status RemoveScan(const std::string& scan_id);
  absl::StatusOr<std::optional<StoredScan>> FindScan(const std::string& scan_id);
  absl::StatusOr<StoredScan> GetScan(const std::string& scan_id);  // SCAN_NOT_FOUND
  // In the answers a header that the database cannot give back whole comes as far as it goes: then the id does not fit.
  // The newest of those stored before `before_sequence`, newest first.
  absl::StatusOr<std::vector<CatalogedScan>> ListScans(int64_t before_sequence, int max_scans);
  absl::StatusOr<std::vector<std::string>> ScansWithPayload(const std::string& digest);

  absl::Status PutUpload(const UploadDescription& upload);  // replaces one of the same id
  absl::Status RemoveUpload(const std::string& upload_id);
  absl::StatusOr<std::vector<UploadDescription>> Uploads();

 private:
  ScanCatalog(SqliteDatabase writer, SqliteDatabase reader);
  absl::Status Change(Durability durability, std::string_view sql, const std::vector<SqlValue>& values);

  std::mutex writer_mutex_;
  SqliteDatabase writer_;
  std::mutex reader_mutex_;
  SqliteDatabase reader_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_SCAN_CATALOG_H_
