// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/scan_catalog.h"

#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/catalog_schema.h"
#include "wire/error.h"
#include "wire/timestamp.h"

namespace curvereg::server {
namespace {

constexpr std::string_view kScanColumns =
    "SELECT sequence, id, header, payload_bytes, payload_digest, finite_point_count, content_digest, create_time_ns "
    "FROM scans ";

std::string ScanQuery(std::string_view rest) { return std::string(kScanColumns).append(rest); }

// The row in the order of kScanColumns. A header that cannot be read comes as far as it goes: the scan's id tells.
CatalogedScan ScanOf(const SqlStatement& row) {
  CatalogedScan result;
  result.sequence = row.Integer(0);
  result.scan.id = row.Bytes(1);
  static_cast<void>(result.scan.header.ParseFromString(row.Bytes(2)));
  result.scan.payload_bytes = static_cast<uint64_t>(row.Integer(3));
  result.scan.payload_digest.set_algorithm(v1::DIGEST_ALGORITHM_XXH3_128);
  result.scan.payload_digest.set_value(row.Bytes(4));
  result.scan.finite_point_count = static_cast<uint64_t>(row.Integer(5));
  result.scan.content_digest = row.Bytes(6);
  result.scan.create_time = wire::TimePointOf(row.Integer(7));
  return result;
}

UploadDescription UploadOf(const SqlStatement& row) {
  UploadDescription upload;
  upload.id = row.Bytes(0);
  static_cast<void>(upload.header.ParseFromString(row.Bytes(1)));
  upload.payload_bytes = static_cast<uint64_t>(row.Integer(2));
  if (row.Integer(3) != v1::DIGEST_ALGORITHM_UNSPECIFIED) {
    upload.payload_digest.emplace();
    upload.payload_digest->set_algorithm(static_cast<v1::DigestAlgorithm>(row.Integer(3)));
    upload.payload_digest->set_value(row.Bytes(4));
  }
  return upload;
}

std::string TextOf(const SqlStatement& row) { return row.Bytes(0); }

}  // namespace

ScanCatalog::ScanCatalog(SqliteDatabase writer, SqliteDatabase reader)
    : writer_(std::move(writer)), reader_(std::move(reader)) {}

absl::StatusOr<std::unique_ptr<ScanCatalog>> ScanCatalog::Open(const std::string& path, bool may_be_new) {
  absl::StatusOr<SqliteDatabase> writer = SqliteDatabase::Open(path);
  if (!writer.ok()) return absl::Status(writer.status().code(), absl::StrCat(path, ": ", writer.status().message()));
  if (absl::Status status = PrepareCatalog(path, may_be_new, *writer); !status.ok()) return status;
  absl::StatusOr<SqliteDatabase> reader = SqliteDatabase::Open(path);
  if (!reader.ok()) return absl::Status(reader.status().code(), absl::StrCat(path, ": ", reader.status().message()));
  return std::unique_ptr<ScanCatalog>(new ScanCatalog(*std::move(writer), *std::move(reader)));
}

absl::Status ScanCatalog::Change(Durability durability, std::string_view sql, const std::vector<SqlValue>& values) {
  const std::lock_guard lock(writer_mutex_);
  absl::StatusOr<SqlTransaction> transaction = SqlTransaction::Begin(writer_, durability);
  if (!transaction.ok()) return transaction.status();
  const absl::Status status = writer_.Execute(sql, values);
  return status.ok() ? transaction->Commit() : status;
}

absl::Status ScanCatalog::AddScan(const StoredScan& scan, const std::string& upload_id) {
  const std::string header = scan.header.SerializeAsString();
  const std::lock_guard lock(writer_mutex_);
  absl::StatusOr<SqlTransaction> transaction = SqlTransaction::Begin(writer_, Durability::kPower);
  if (!transaction.ok()) return transaction.status();
  absl::Status status = writer_.Execute(
      "INSERT INTO scans(id, header, payload_bytes, payload_digest, finite_point_count, content_digest, "
      "create_time_ns) VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7)",
      {scan.id, SqlBlob{header}, static_cast<int64_t>(scan.payload_bytes), SqlBlob{scan.payload_digest.value()},
       static_cast<int64_t>(scan.finite_point_count), scan.content_digest, wire::NanosecondsOf(scan.create_time)});
  if (status.ok()) status = writer_.Execute("DELETE FROM uploads WHERE id=?1", {upload_id});
  return status.ok() ? transaction->Commit() : status;
}

absl::Status ScanCatalog::RemoveScan(const std::string& scan_id) {
  return Change(Durability::kPower, "DELETE FROM scans WHERE id=?1", {scan_id});
}

absl::StatusOr<std::optional<StoredScan>> ScanCatalog::FindScan(const std::string& scan_id) {
  const std::lock_guard lock(reader_mutex_);
  absl::StatusOr<std::vector<CatalogedScan>> rows =
      CollectRows(reader_.Prepare(ScanQuery("WHERE id=?1"), {scan_id}), ScanOf);
  if (!rows.ok()) return rows.status();
  if (rows->empty()) return std::optional<StoredScan>();
  return std::optional<StoredScan>(std::move(rows->front().scan));
}

absl::StatusOr<StoredScan> ScanCatalog::GetScan(const std::string& scan_id) {
  absl::StatusOr<std::optional<StoredScan>> scan = FindScan(scan_id);
  if (!scan.ok()) return scan.status();
  if (scan->has_value()) return **std::move(scan);
  return wire::MakeError(v1::ERROR_REASON_SCAN_NOT_FOUND, absl::StrCat("no scan of the name ", scan_id));
}

absl::StatusOr<std::vector<CatalogedScan>> ScanCatalog::ListScans(int64_t before_sequence, int max_scans) {
  const std::lock_guard lock(reader_mutex_);
  return CollectRows(reader_.Prepare(ScanQuery("WHERE sequence<?1 ORDER BY sequence DESC LIMIT ?2"),
                                     {before_sequence, int64_t{max_scans}}),
                     ScanOf);
}

absl::StatusOr<std::vector<std::string>> ScanCatalog::ScansWithPayload(const std::string& digest) {
  const std::lock_guard lock(reader_mutex_);
  return CollectRows(reader_.Prepare("SELECT id FROM scans WHERE payload_digest=?1", {SqlBlob{digest}}), TextOf);
}

absl::Status ScanCatalog::PutUpload(const UploadDescription& upload) {
  const std::string header = upload.header.SerializeAsString();
  const v1::Digest digest = upload.payload_digest.value_or(v1::Digest());
  return Change(Durability::kProcess,
                "INSERT OR REPLACE INTO uploads(id, header, payload_bytes, digest_algorithm, digest) "
                "VALUES(?1, ?2, ?3, ?4, ?5)",
                {upload.id, SqlBlob{header}, static_cast<int64_t>(upload.payload_bytes), int64_t{digest.algorithm()},
                 SqlBlob{digest.value()}});
}

absl::Status ScanCatalog::RemoveUpload(const std::string& upload_id) {
  return Change(Durability::kProcess, "DELETE FROM uploads WHERE id=?1", {upload_id});
}

absl::StatusOr<std::vector<UploadDescription>> ScanCatalog::Uploads() {
  const std::lock_guard lock(reader_mutex_);
  return CollectRows(reader_.Prepare("SELECT id, header, payload_bytes, digest_algorithm, digest FROM uploads"),
                     UploadOf);
}

}  // namespace curvereg::server
