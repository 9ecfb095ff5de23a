// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// SQLite for one thread at a time: connections, statements and transactions that clean up after themselves. Errors are
// STORAGE_FULL when the disk is full, else STORAGE_FAULT.
#ifndef CURVEREG_SERVER_STORE_SQLITE_DATABASE_H_
#define CURVEREG_SERVER_STORE_SQLITE_DATABASE_H_

#include <sqlite3.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace curvereg::server {

// Bytes, as opposed to text. Borrowed.
struct SqlBlob {
  std::string_view bytes;
};
using SqlValue = std::variant<int64_t, std::string_view, SqlBlob>;

// A query under way. Must not outlive its database.
class SqlStatement {
 public:
  // True: a row is there; false: that was all.
  absl::StatusOr<bool> Step();
  // Of the row that is there, columns from 0.
  int64_t Integer(int column) const;
  std::string Bytes(int column) const;  // of text or a blob

 private:
  friend class SqliteDatabase;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  explicit SqlStatement(sqlite3_stmt* statement) : statement_(statement) {}
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

// One connection. Movable, not shared between threads.
class SqliteDatabase {
 public:
  // Creates the file if need be. Whether it is a database shows at the first statement.
  static absl::StatusOr<SqliteDatabase> Open(const std::string& path);

  // A query with its parameters ?1, ?2, ... bound; they are copied.
  absl::StatusOr<SqlStatement> Prepare(std::string_view sql, const std::vector<SqlValue>& values = {});
  // Runs one statement to its end; rows are dropped.
  absl::Status Execute(std::string_view sql, const std::vector<SqlValue>& values = {});
  // The number in the first column of the first row; 0 when there is no row.
  absl::StatusOr<int64_t> QueryInteger(std::string_view sql, const std::vector<SqlValue>& values = {});

  // What last failed did so because the file is damaged or not a database.
  bool IsDamaged() const;
  // Rows that the last INSERT, UPDATE or DELETE changed.
  int num_changed_rows() const { return sqlite3_changes(database_.get()); }

 private:
  friend class SqlTransaction;
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
  };
  std::unique_ptr<sqlite3, Close> database_;
};

// All rows of a query, each as `read` makes it of a statement with a row.
template <typename Read>
auto CollectRows(absl::StatusOr<SqlStatement> query, const Read& read)
    -> absl::StatusOr<std::vector<decltype(read(*query))>> {
  if (!query.ok()) return query.status();
  std::vector<decltype(read(*query))> rows;
  absl::StatusOr<bool> has_row = query->Step();
  for (; has_row.ok() && *has_row; has_row = query->Step()) rows.push_back(read(*query));
  if (!has_row.ok()) return has_row.status();
  return rows;
}

enum class Durability {
  kProcess,  // survives the death of the process; a loss of power may take it back, never half of it
  kPower,    // forced to disk
};

// Takes everything back unless Commit succeeds.
class SqlTransaction {
 public:
  static absl::StatusOr<SqlTransaction> Begin(SqliteDatabase& database, Durability durability);
  SqlTransaction(SqlTransaction&& other) noexcept : database_(other.database_) { other.database_ = nullptr; }
  SqlTransaction& operator=(SqlTransaction&&) = delete;
  ~SqlTransaction();
  absl::Status Commit();

 private:
  explicit SqlTransaction(SqliteDatabase& database) : database_(&database) {}
  SqliteDatabase* database_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_SQLITE_DATABASE_H_
