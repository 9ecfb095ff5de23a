// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Versions of a database's tables.
#ifndef CURVEREG_SERVER_STORE_DATABASE_SCHEMA_H_
#define CURVEREG_SERVER_STORE_DATABASE_SCHEMA_H_

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "server/store/sqlite_database.h"

namespace curvereg::server {

// What brings version i to version i + 1, statement by statement; PRAGMA user_version tells the version. Only ever
// append: databases of every version are in use.
using Migrations = std::vector<std::vector<std::string_view>>;

// Checks the database at `path`, turns its write-ahead log on and brings its tables up to date. `may_be_new`: an empty
// database is a new one. DATA_LOSS: damaged, or empty where it may not be; FAILED_PRECONDITION: made by a newer
// version, or a file system that cannot keep a log; messages name the file and tell what to do. Others: cannot be read
// or written.
absl::Status PrepareDatabase(const std::string& path, bool may_be_new, const Migrations& migrations,
                             SqliteDatabase& database);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_DATABASE_SCHEMA_H_
