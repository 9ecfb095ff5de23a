// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Tables of the store's database and their versions.
#ifndef CURVEREG_SERVER_STORE_CATALOG_SCHEMA_H_
#define CURVEREG_SERVER_STORE_CATALOG_SCHEMA_H_

#include <string>

#include "absl/status/status.h"
#include "server/store/sqlite_database.h"

namespace curvereg::server {

// Checks the database at `path` and brings its tables up to date; see ScanCatalog::Open for parameters and errors.
absl::Status PrepareCatalog(const std::string& path, bool may_be_new, SqliteDatabase& database);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_CATALOG_SCHEMA_H_
