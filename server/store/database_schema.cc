// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/database_schema.h"

#include <cstddef>
#include <cstdint>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"

namespace curvereg::server {
namespace {

absl::Status DamagedError(const std::string& path, std::string_view what) {
  return absl::DataLossError(absl::StrCat(
      path, ": the store's database is damaged: ", std::string(what),
      ". Stop here and keep the folder: restore it from a backup, or recover the file with the sqlite3 program "
      "(.recover) in its place; to begin with an empty store, name another data folder"));
}

// Turns an error of the database at start-up into one that tells what to do.
absl::Status StartupError(const std::string& path, const SqliteDatabase& database, const absl::Status& status) {
  if (database.IsDamaged()) return DamagedError(path, std::string(status.message()));
  return absl::Status(status.code(), absl::StrCat(path, ": ", status.message()));
}

absl::Status UseWriteAheadLog(const std::string& path, SqliteDatabase& database) {
  absl::StatusOr<SqlStatement> mode = database.Prepare("PRAGMA journal_mode=WAL");
  if (!mode.ok()) return mode.status();
  const absl::StatusOr<bool> has_row = mode->Step();
  if (!has_row.ok()) return has_row.status();
  if (*has_row && mode->Bytes(0) == "wal") return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat(path, ": the file system cannot hold a write-ahead log; put the data folder on a local disk"));
}

absl::Status CheckWhole(const std::string& path, SqliteDatabase& database) {
  absl::StatusOr<SqlStatement> check = database.Prepare("PRAGMA quick_check(1)");
  if (!check.ok()) return StartupError(path, database, check.status());
  const absl::StatusOr<bool> has_row = check->Step();
  if (!has_row.ok()) return StartupError(path, database, has_row.status());
  const std::string found = *has_row ? check->Bytes(0) : "no answer";
  return found == "ok" ? absl::OkStatus() : DamagedError(path, found);
}

absl::Status Migrate(int64_t version, const Migrations& migrations, SqliteDatabase& database) {
  if (version == static_cast<int64_t>(migrations.size())) return absl::OkStatus();
  absl::StatusOr<SqlTransaction> transaction = SqlTransaction::Begin(database, Durability::kPower);
  if (!transaction.ok()) return transaction.status();
  for (std::size_t i = static_cast<std::size_t>(version); i < migrations.size(); ++i) {
    for (const std::string_view statement : migrations[i]) {
      if (absl::Status status = database.Execute(statement); !status.ok()) return status;
    }
  }
  absl::Status status = database.Execute(absl::StrCat("PRAGMA user_version=", migrations.size()));
  return status.ok() ? transaction->Commit() : status;
}

}  // namespace

absl::Status PrepareDatabase(const std::string& path, bool may_be_new, const Migrations& migrations,
                             SqliteDatabase& database) {
  const absl::StatusOr<int64_t> version = database.QueryInteger("PRAGMA user_version");
  if (!version.ok()) return StartupError(path, database, version.status());
  if (*version < 0 || *version > static_cast<int64_t>(migrations.size())) {
    return absl::FailedPreconditionError(absl::StrCat(path, ": made by a newer version of curvereg (schema ", *version,
                                                      ", known up to ", migrations.size(), "); run that one"));
  }
  if (*version == 0 && !may_be_new) return DamagedError(path, "it is empty or missing, but the folder has been in use");
  if (absl::Status status = CheckWhole(path, database); !status.ok()) return status;
  if (absl::Status status = UseWriteAheadLog(path, database); !status.ok()) {
    return status.code() == absl::StatusCode::kFailedPrecondition ? status : StartupError(path, database, status);
  }
  const absl::Status status = Migrate(*version, migrations, database);
  return status.ok() ? status : StartupError(path, database, status);
}

}  // namespace curvereg::server
