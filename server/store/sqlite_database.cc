// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/sqlite_database.h"

#include <cerrno>
#include <cstddef>
#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

// The two connections of a store wait for each other only while one of them resets the log: milliseconds.
constexpr int kBusyTimeoutMs = 10'000;

absl::Status DatabaseError(sqlite3* database) {
  const int code = sqlite3_errcode(database) & 0xff;
  const int cause = sqlite3_system_errno(database);
  const bool is_io_fault = code == SQLITE_IOERR || code == SQLITE_CANTOPEN;
  const bool is_full = code == SQLITE_FULL || (is_io_fault && (cause == ENOSPC || cause == EDQUOT));
  return wire::MakeError(is_full ? v1::ERROR_REASON_STORAGE_FULL : v1::ERROR_REASON_STORAGE_FAULT,
                         absl::StrCat("the store's database: ", sqlite3_errmsg(database)));
}

int Bind(sqlite3_stmt* statement, int index, const SqlValue& value) {
  if (const auto* integer = std::get_if<int64_t>(&value)) return sqlite3_bind_int64(statement, index, *integer);
  if (const auto* text = std::get_if<std::string_view>(&value)) {
    return sqlite3_bind_text64(statement, index, text->data(), text->size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  }
  const std::string_view bytes = std::get<SqlBlob>(value).bytes;
  // A null pointer would bind NULL in place of no bytes.
  return sqlite3_bind_blob64(statement, index, bytes.empty() ? "" : bytes.data(), bytes.size(), SQLITE_TRANSIENT);
}

}  // namespace

absl::StatusOr<bool> SqlStatement::Step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return DatabaseError(sqlite3_db_handle(statement_.get()));
}

int64_t SqlStatement::Integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }

std::string SqlStatement::Bytes(int column) const {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return bytes == nullptr ? std::string()
                          : std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
}

absl::StatusOr<SqliteDatabase> SqliteDatabase::Open(const std::string& path) {
  sqlite3* handle = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
  const int code = sqlite3_open_v2(path.c_str(), &handle, flags, nullptr);
  SqliteDatabase database;
  database.database_.reset(handle);
  if (handle == nullptr) return wire::MakeError(v1::ERROR_REASON_STORAGE_FAULT, "no memory for a database");
  if (code != SQLITE_OK) return DatabaseError(handle);
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_timeout(handle, kBusyTimeoutMs);
  // Pages that become free are not filled with zeros, where that is the default: a deletion would write, and need room
  // for, as much as it deletes.
  if (absl::Status status = database.Execute("PRAGMA secure_delete=FAST"); !status.ok()) return status;
  return database;
}

absl::StatusOr<SqlStatement> SqliteDatabase::Prepare(std::string_view sql, const std::vector<SqlValue>& values) {
  sqlite3_stmt* handle = nullptr;
  const int code = sqlite3_prepare_v2(database_.get(), sql.data(), static_cast<int>(sql.size()), &handle, nullptr);
  if (code != SQLITE_OK) return DatabaseError(database_.get());
  SqlStatement statement(handle);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (Bind(handle, static_cast<int>(i) + 1, values[i]) != SQLITE_OK) return DatabaseError(database_.get());
  }
  return statement;
}

absl::Status SqliteDatabase::Execute(std::string_view sql, const std::vector<SqlValue>& values) {
  absl::StatusOr<SqlStatement> statement = Prepare(sql, values);
  if (!statement.ok()) return statement.status();
  absl::StatusOr<bool> has_row = true;
  while (has_row.ok() && *has_row) has_row = statement->Step();
  return has_row.status();
}

absl::StatusOr<int64_t> SqliteDatabase::QueryInteger(std::string_view sql, const std::vector<SqlValue>& values) {
  absl::StatusOr<SqlStatement> statement = Prepare(sql, values);
  if (!statement.ok()) return statement.status();
  const absl::StatusOr<bool> has_row = statement->Step();
  if (!has_row.ok()) return has_row.status();
  return *has_row ? statement->Integer(0) : 0;
}

bool SqliteDatabase::IsDamaged() const {
  const int code = sqlite3_errcode(database_.get()) & 0xff;
  return code == SQLITE_CORRUPT || code == SQLITE_NOTADB;
}

absl::StatusOr<SqlTransaction> SqlTransaction::Begin(SqliteDatabase& database, Durability durability) {
  absl::Status status =
      database.Execute(durability == Durability::kPower ? "PRAGMA synchronous=FULL" : "PRAGMA synchronous=NORMAL");
  if (status.ok()) status = database.Execute("BEGIN IMMEDIATE");
  if (!status.ok()) return status;
  return SqlTransaction(database);
}

absl::Status SqlTransaction::Commit() { return database_->Execute("COMMIT"); }

SqlTransaction::~SqlTransaction() {
  // A COMMIT that failed may have left it open.
  if (database_ == nullptr || sqlite3_get_autocommit(database_->database_.get()) != 0) return;
  static_cast<void>(database_->Execute("ROLLBACK"));
}

}  // namespace curvereg::server
