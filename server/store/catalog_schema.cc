// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/catalog_schema.h"

#include "server/store/database_schema.h"

namespace curvereg::server {

absl::Status PrepareCatalog(const std::string& path, bool may_be_new, SqliteDatabase& database) {
  const Migrations migrations = {{
      // AUTOINCREMENT: a page token is a place in this order, so no place may come back with another scan.
      R"(CREATE TABLE scans(
           sequence INTEGER PRIMARY KEY AUTOINCREMENT,
           id TEXT NOT NULL UNIQUE,
           header BLOB NOT NULL,
           payload_bytes INTEGER NOT NULL,
           payload_digest BLOB NOT NULL,
           finite_point_count INTEGER NOT NULL,
           content_digest TEXT NOT NULL,
           create_time_ns INTEGER NOT NULL) STRICT)",
      "CREATE INDEX scans_by_payload ON scans(payload_digest, payload_bytes)",
      R"(CREATE TABLE uploads(
           id TEXT PRIMARY KEY,
           header BLOB NOT NULL,
           payload_bytes INTEGER NOT NULL,
           digest_algorithm INTEGER NOT NULL,
           digest BLOB NOT NULL) STRICT, WITHOUT ROWID)",
  }};
  return PrepareDatabase(path, may_be_new, migrations, database);
}

}  // namespace curvereg::server
