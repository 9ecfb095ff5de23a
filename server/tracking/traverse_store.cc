// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_store.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/database_schema.h"
#include "server/tracking/traverse_tables.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

int64_t Signed(uint64_t value) { return static_cast<int64_t>(value); }
uint64_t Unsigned(int64_t value) { return static_cast<uint64_t>(value); }

// Reads messages out of rows and remembers whether all could be read.
class MessageReader {
 public:
  template <typename Message>
  Message Read(const SqlStatement& row, int column) {
    Message message;
    is_intact_ = message.ParseFromString(row.Bytes(column)) && is_intact_;
    return message;
  }

  template <typename Rows>
  absl::StatusOr<Rows> Checked(absl::StatusOr<Rows> rows) const {
    if (!rows.ok() || is_intact_) return rows;
    return wire::MakeError(v1::ERROR_REASON_STORAGE_FAULT, "the database of traverses has a row that cannot be read");
  }

 private:
  bool is_intact_ = true;
};

TraverseRecord RecordOf(MessageReader& reader, const SqlStatement& row) {
  TraverseRecord record;
  record.number = row.Integer(0);
  record.traverse = reader.Read<v1::Traverse>(row, 1);
  record.num_events = Unsigned(row.Integer(2));
  record.num_segments_begun = static_cast<int>(row.Integer(3));
  record.num_linked_scans = Unsigned(row.Integer(4));
  record.num_links = Unsigned(row.Integer(5));
  record.num_revised_links = Unsigned(row.Integer(6));
  record.num_revised_scans = Unsigned(row.Integer(7));
  record.fencing_number = Unsigned(row.Integer(8));
  return record;
}

AcknowledgedScan ScanOf(MessageReader& reader, const SqlStatement& row) {
  return {reader.Read<v1::StreamedScanHeader>(row, 0), row.Bytes(1), row.Integer(2)};
}

StoredLink LinkOf(MessageReader& reader, const SqlStatement& row) {
  return {Unsigned(row.Integer(0)), Unsigned(row.Integer(1)), static_cast<LinkKind>(row.Integer(2)),
          reader.Read<v1::RegistrationResult>(row, 3)};
}

// The sequence number whose result the event is, else -1.
int64_t SequenceOf(const v1::WatchTraverseResponse& event) {
  return event.has_result() ? Signed(event.result().sequence_number()) : -1;
}

}  // namespace

TraverseStore::TraverseStore(SqliteDatabase writer, SqliteDatabase reader)
    : writer_(std::move(writer)), reader_(std::move(reader)) {}

absl::StatusOr<std::unique_ptr<TraverseStore>> TraverseStore::Open(const std::string& path, bool may_be_new) {
  const auto of_path = [&](const absl::Status& status) {
    return absl::Status(status.code(), absl::StrCat(path, ": ", status.message()));
  };
  absl::StatusOr<SqliteDatabase> writer = SqliteDatabase::Open(path);
  if (!writer.ok()) return of_path(writer.status());
  if (absl::Status status = PrepareDatabase(path, may_be_new, TraverseTables(), *writer); !status.ok()) return status;
  absl::StatusOr<SqliteDatabase> reader = SqliteDatabase::Open(path);
  if (!reader.ok()) return of_path(reader.status());
  return std::unique_ptr<TraverseStore>(new TraverseStore(*std::move(writer), *std::move(reader)));
}

absl::Status TraverseStore::Change(const std::function<absl::Status()>& change) {
  const std::lock_guard lock(writer_mutex_);
  absl::StatusOr<SqlTransaction> transaction = SqlTransaction::Begin(writer_, Durability::kPower);
  if (!transaction.ok()) return transaction.status();
  const absl::Status status = change();
  return status.ok() ? transaction->Commit() : status;
}

absl::Status TraverseStore::Run(std::initializer_list<std::string_view> statements,
                                const std::vector<SqlValue>& values) {
  for (const std::string_view statement : statements) {
    if (absl::Status status = writer_.Execute(statement, values); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<TraverseRecord>> TraverseStore::Traverses() {
  const std::lock_guard lock(reader_mutex_);
  MessageReader reader;
  return reader.Checked(CollectRows(
      reader_.Prepare("SELECT number, traverse, num_events, num_segments_begun, num_linked_scans, num_links, "
                      "num_revised_links, num_revised_scans, IFNULL(fencing, 0) "
                      "FROM traverses LEFT JOIN streams ON streams.traverse_number=number ORDER BY number"),
      [&](const SqlStatement& row) { return RecordOf(reader, row); }));
}

absl::Status TraverseStore::AddTraverse(TraverseRecord& record) {
  return Change([&] {
    absl::Status status = Run({"INSERT INTO traverses(id, traverse) VALUES(?1, x'')"}, {record.traverse.name()});
    if (!status.ok()) return status;
    const absl::StatusOr<int64_t> number = writer_.QueryInteger("SELECT last_insert_rowid()");
    if (!number.ok()) return number.status();
    record.number = *number;
    return PutRecord(record);
  });
}

absl::Status TraverseStore::RemoveTraverse(int64_t number) {
  return Change([&] {
    return Run(
        {
            "INSERT OR IGNORE INTO doomed_scans SELECT DISTINCT scan_id FROM scans WHERE traverse=?1 AND NOT EXISTS "
            "(SELECT 1 FROM scans other WHERE other.scan_id=scans.scan_id AND other.traverse<>?1)",
            "DELETE FROM traverses WHERE number=?1",
            "DELETE FROM streams WHERE traverse_number=?1",
            "DELETE FROM scans WHERE traverse=?1",
            "DELETE FROM poses WHERE traverse=?1",
            "DELETE FROM links WHERE traverse=?1",
            "DELETE FROM events WHERE traverse=?1",
        },
        {number});
  });
}

absl::Status TraverseStore::Fence(TraverseRecord& record) {
  return Change([&] {
    absl::Status status = Run({"INSERT OR REPLACE INTO streams(traverse_number) VALUES(?1)"}, {record.number});
    if (!status.ok()) return status;
    const absl::StatusOr<int64_t> fencing =
        writer_.QueryInteger("SELECT fencing FROM streams WHERE traverse_number=?1", {record.number});
    if (fencing.ok()) record.fencing_number = Unsigned(*fencing);
    return fencing.status();
  });
}

absl::Status TraverseStore::AddScan(const TraverseRecord& record, const AcknowledgedScan& scan) {
  return Change([&] {
    const std::string header = scan.header.SerializeAsString();
    absl::Status status =
        Run({"INSERT INTO scans(traverse, sequence, scan_id, header, time_ns) VALUES(?1, ?2, ?3, ?4, ?5)"},
            {record.number, Signed(scan.header.sequence_number()), scan.scan_id, SqlBlob{header}, scan.time_ns});
    // A scan that a removed traverse left behind is wanted again.
    if (status.ok()) status = Run({"DELETE FROM doomed_scans WHERE scan_id=?1"}, {scan.scan_id});
    return status.ok() ? PutRecord(record) : status;
  });
}

absl::StatusOr<std::optional<AcknowledgedScan>> TraverseStore::FindScan(int64_t number, uint64_t sequence_number) {
  const std::lock_guard lock(reader_mutex_);
  MessageReader reader;
  absl::StatusOr<std::vector<AcknowledgedScan>> rows = reader.Checked(
      CollectRows(reader_.Prepare("SELECT header, scan_id, time_ns FROM scans WHERE traverse=?1 AND sequence=?2",
                                  {number, Signed(sequence_number)}),
                  [&](const SqlStatement& row) { return ScanOf(reader, row); }));
  if (!rows.ok()) return rows.status();
  if (rows->empty()) return std::optional<AcknowledgedScan>();
  return std::optional<AcknowledgedScan>(std::move(rows->front()));
}

absl::StatusOr<std::vector<AcknowledgedScan>> TraverseStore::Scans(int64_t number, uint64_t first, int64_t max_scans) {
  const std::lock_guard lock(reader_mutex_);
  MessageReader reader;
  return reader.Checked(CollectRows(
      reader_.Prepare("SELECT header, scan_id, time_ns FROM scans WHERE traverse=?1 AND sequence>=?2 ORDER BY sequence "
                      "LIMIT ?3",
                      {number, Signed(first), max_scans}),
      [&](const SqlStatement& row) { return ScanOf(reader, row); }));
}

absl::StatusOr<bool> TraverseStore::IsScanUsed(const std::string& scan_id) {
  const std::lock_guard lock(reader_mutex_);
  const absl::StatusOr<int64_t> found =
      reader_.QueryInteger("SELECT EXISTS(SELECT 1 FROM scans WHERE scan_id=?1)", {scan_id});
  if (!found.ok()) return found.status();
  return *found != 0;
}

absl::StatusOr<std::vector<std::string>> TraverseStore::PendingDeletions() {
  const std::lock_guard lock(reader_mutex_);
  return CollectRows(reader_.Prepare("SELECT scan_id FROM doomed_scans ORDER BY scan_id"),
                     [](const SqlStatement& row) { return row.Bytes(0); });
}

absl::Status TraverseStore::CancelDeletion(const std::string& scan_id) {
  return Change([&] { return Run({"DELETE FROM doomed_scans WHERE scan_id=?1"}, {scan_id}); });
}

absl::Status TraverseStore::AddStep(const TraverseRecord& record, const TraverseStep& step) {
  return Change([&] {
    const absl::Status status = PutStep(record, step);
    return status.ok() ? PutRecord(record) : status;
  });
}

absl::Status TraverseStore::PutStep(const TraverseRecord& record, const TraverseStep& step) {
  absl::Status status;
  for (const v1::TrajectoryPose& pose : step.poses) {
    const std::string bytes = pose.SerializeAsString();
    status = Run({"INSERT OR REPLACE INTO poses(traverse, sequence, pose) VALUES(?1, ?2, ?3)"},
                 {record.number, Signed(pose.sequence_number()), SqlBlob{bytes}});
    if (!status.ok()) return status;
  }
  uint64_t link_number = record.num_links - step.links.size();
  for (const StoredLink& link : step.links) {
    const std::string result = link.result.SerializeAsString();
    status = Run({"INSERT INTO links(traverse, number, source, target, kind, result) VALUES(?1, ?2, ?3, ?4, ?5, ?6)"},
                 {record.number, Signed(link_number++), Signed(link.source), Signed(link.target),
                  static_cast<int64_t>(link.kind), SqlBlob{result}});
    if (!status.ok()) return status;
  }
  for (const v1::WatchTraverseResponse& event : step.events) {
    const std::string bytes = event.SerializeAsString();
    status = Run({"INSERT INTO events(traverse, number, sequence, event) VALUES(?1, ?2, ?3, ?4)"},
                 {record.number, Signed(event.event()), SequenceOf(event), SqlBlob{bytes}});
    if (!status.ok()) return status;
  }
  return status;
}

absl::Status TraverseStore::PutRecord(const TraverseRecord& record) {
  const std::string traverse = record.traverse.SerializeAsString();
  return Run({"UPDATE traverses SET traverse=?2, num_events=?3, num_segments_begun=?4, num_linked_scans=?5, "
              "num_links=?6, num_revised_links=?7, num_revised_scans=?8 WHERE number=?1"},
             {record.number, SqlBlob{traverse}, Signed(record.num_events), int64_t{record.num_segments_begun},
              Signed(record.num_linked_scans), Signed(record.num_links), Signed(record.num_revised_links),
              Signed(record.num_revised_scans)});
}

absl::StatusOr<StoredPoses> TraverseStore::Poses(int64_t number, uint64_t first, int64_t max_poses) {
  const std::lock_guard lock(reader_mutex_);
  // One statement sees one moment.
  constexpr std::string_view kQuery =
      "SELECT traverse, x'', -1 FROM traverses WHERE number=?1 UNION ALL SELECT x'', pose, sequence FROM (SELECT pose, "
      "sequence FROM poses WHERE traverse=?1 AND sequence>=?2 ORDER BY sequence LIMIT ?3) ORDER BY 3";
  MessageReader reader;
  StoredPoses stored;
  const auto rows = reader.Checked(
      CollectRows(reader_.Prepare(kQuery, {number, Signed(first), max_poses}), [&](const SqlStatement& row) {
        if (row.Integer(2) < 0) {
          stored.traverse = reader.Read<v1::Traverse>(row, 0);
        } else {
          stored.poses.push_back(reader.Read<v1::TrajectoryPose>(row, 1));
        }
        return true;
      }));
  if (!rows.ok()) return rows.status();
  return stored;
}

absl::StatusOr<std::vector<StoredLink>> TraverseStore::Links(int64_t number) {
  const std::lock_guard lock(reader_mutex_);
  MessageReader reader;
  return reader.Checked(CollectRows(
      reader_.Prepare("SELECT source, target, kind, result FROM links WHERE traverse=?1 ORDER BY number", {number}),
      [&](const SqlStatement& row) { return LinkOf(reader, row); }));
}

absl::StatusOr<std::vector<v1::WatchTraverseResponse>> TraverseStore::Events(int64_t number, uint64_t first,
                                                                             int64_t max_events) {
  const std::lock_guard lock(reader_mutex_);
  MessageReader reader;
  return reader.Checked(
      CollectRows(reader_.Prepare("SELECT event FROM events WHERE traverse=?1 AND number>=?2 ORDER BY number LIMIT ?3",
                                  {number, Signed(first), max_events}),
                  [&](const SqlStatement& row) { return reader.Read<v1::WatchTraverseResponse>(row, 0); }));
}

absl::StatusOr<std::vector<v1::ScanResult>> TraverseStore::Results(int64_t number, uint64_t first_sequence_number,
                                                                   int64_t max_results) {
  const std::lock_guard lock(reader_mutex_);
  MessageReader reader;
  return reader.Checked(CollectRows(
      reader_.Prepare("SELECT event FROM events WHERE traverse=?1 AND sequence>=?2 AND sequence>=0 ORDER BY sequence "
                      "LIMIT ?3",
                      {number, Signed(first_sequence_number), max_results}),
      [&](const SqlStatement& row) {
        return std::move(*reader.Read<v1::WatchTraverseResponse>(row, 0).mutable_result());
      }));
}

}  // namespace curvereg::server
