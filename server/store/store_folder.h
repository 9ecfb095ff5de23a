// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a store keeps open as long as it lives: its locked folder, the database and the files in it.
#ifndef CURVEREG_SERVER_STORE_STORE_FOLDER_H_
#define CURVEREG_SERVER_STORE_STORE_FOLDER_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/store/orphaned_files.h"
#include "server/store/payload_files.h"
#include "server/store/removal_marks.h"
#include "server/store/reserved_space.h"
#include "server/store/scan_catalog.h"
#include "server/store/store_file.h"

namespace curvereg::server {

struct StoreFolder {
  // Creates what is missing and locks it. Errors as ScanStore::Open.
  static absl::StatusOr<std::unique_ptr<StoreFolder>> Open(const std::string& path);
  StoreFolder(const std::string& folder, StoreFile lock_file);

  // Of a payload among orphaned files and removal marks.
  static std::string LabelOf(const std::string& digest);
  std::string uploads_path() const { return path + "/uploads"; }

  const std::string path;
  const StoreFile lock;
  PayloadFiles payloads;
  OrphanedFiles orphaned;
  RemovalMarks removals;
  ReservedSpace reserved;
  std::unique_ptr<ScanCatalog> catalog;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_STORE_FOLDER_H_
