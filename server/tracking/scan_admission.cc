// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/scan_admission.h"

#include <chrono>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/scan_identity.h"
#include "server/tracking/traverse_conversion.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/resource_names.h"
#include "wire/timestamp.h"

namespace curvereg::server {
namespace {

// Digests of different algorithms cannot be compared: then the stored scan decides.
bool MayBeSame(const v1::StreamedScanHeader& a, const v1::StreamedScanHeader& b) {
  return a.payload_bytes() == b.payload_bytes() && CanonicalHeader(a.header()) == CanonicalHeader(b.header()) &&
         (a.payload_digest().algorithm() != b.payload_digest().algorithm() ||
          wire::SameDigest(a.payload_digest(), b.payload_digest()));
}

absl::Status DiffersError(uint64_t sequence_number) {
  return wire::MakeError(v1::ERROR_REASON_SEQUENCE_DIFFERS,
                         absl::StrCat("scan ", sequence_number, " is there already, and is another one"));
}

// `next`: the least sequence number that is not acknowledged.
uint64_t NextAfter(uint64_t sequence_number, uint64_t next, std::set<uint64_t>& early) {
  early.insert(sequence_number);
  while (early.erase(next) > 0) ++next;
  return next;
}

}  // namespace

ScanAdmission::ScanAdmission(const TrackingEnvironment& environment, std::shared_ptr<TraverseJournal> journal,
                             std::set<uint64_t> early)
    : environment_(environment),
      journal_(std::move(journal)),
      name_(journal_->record().traverse.name()),
      early_(std::move(early)) {}

absl::StatusOr<StreamTicket> ScanAdmission::BeginStream(const std::stop_source& owner) {
  std::stop_source former(std::nostopstate);
  StreamTicket ticket;
  {
    const std::lock_guard lock(mutex_);
    const absl::Status fenced = journal_->Change(
        [this](TraverseRecord& record) { return environment_.store->Fence(record); }, TraverseNotFound(name_));
    if (!fenced.ok()) return fenced;
    const TraverseRecord record = journal_->record();
    former = std::exchange(owner_, owner);
    ticket = {*wire::TraverseIdOf(name_, "name"), record.fencing_number, record.traverse.next_sequence_number(),
              record.traverse.settings().reorder_window()};
  }
  former.request_stop();  // runs the other stream's reaction, so without a lock of ours
  return ticket;
}

void ScanAdmission::EndStream() {
  std::stop_source owner(std::nostopstate);
  {
    const std::lock_guard lock(mutex_);
    owner = std::exchange(owner_, std::stop_source(std::nostopstate));
  }
  owner.request_stop();
}

absl::Status ScanAdmission::CheckScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                      bool* known) const {
  const std::lock_guard lock(mutex_);
  return Check(ticket, header, known);
}

absl::Status ScanAdmission::Check(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) const {
  if (journal_->is_closed()) return TraverseNotFound(name_);
  const TraverseRecord record = journal_->record();
  if (ticket.fencing_number != record.fencing_number) {
    return wire::MakeError(v1::ERROR_REASON_WRITER_REPLACED, "another stream took the traverse over");
  }
  const uint64_t sequence_number = header.sequence_number();
  *known = sequence_number < record.traverse.next_sequence_number() || early_.contains(sequence_number);
  return *known ? CheckKnown(record, header) : CheckNew(record, header);
}

absl::Status ScanAdmission::CheckKnown(const TraverseRecord& record, const v1::StreamedScanHeader& header) const {
  const absl::StatusOr<std::optional<AcknowledgedScan>> scan =
      environment_.store->FindScan(record.number, header.sequence_number());
  if (!scan.ok()) return scan.status();
  if (scan->has_value() && MayBeSame((*scan)->header, header)) return absl::OkStatus();
  return DiffersError(header.sequence_number());
}

absl::Status ScanAdmission::CheckNew(const TraverseRecord& record, const v1::StreamedScanHeader& header) const {
  const uint64_t sequence_number = header.sequence_number();
  const uint64_t next = record.traverse.next_sequence_number();
  if (sequence_number > next + record.traverse.settings().reorder_window()) {
    return wire::MakeError(v1::ERROR_REASON_SEQUENCE_OUT_OF_RANGE, "the sequence number leaves a gap",
                           {{"next_sequence_number", absl::StrCat(next)}});
  }
  const int max_scans = environment_.scans.limits.max_scans_per_traverse;
  if (sequence_number >= static_cast<uint64_t>(max_scans)) {
    return wire::MakeError(v1::ERROR_REASON_TRAVERSE_FULL, "the traverse has as many scans as it may",
                           {{"limit", absl::StrCat(max_scans)}});
  }
  return wire::WithinField("header", PriorOf(header).status());
}

absl::StatusOr<uint64_t> ScanAdmission::AddScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                                const std::string& scan_id) {
  const std::unique_lock uses = environment_.uses->Lock();
  const std::lock_guard lock(mutex_);
  bool known = false;
  if (absl::Status status = Check(ticket, header, &known); !status.ok()) return status;
  return known ? AcknowledgeAgain(header.sequence_number(), scan_id) : Acknowledge(header, scan_id);
}

absl::StatusOr<uint64_t> ScanAdmission::AcknowledgeAgain(uint64_t sequence_number, const std::string& scan_id) const {
  const TraverseRecord record = journal_->record();
  const absl::StatusOr<std::optional<AcknowledgedScan>> scan =
      environment_.store->FindScan(record.number, sequence_number);
  if (!scan.ok()) return scan.status();
  if (!scan->has_value() || (*scan)->scan_id != scan_id) return DiffersError(sequence_number);
  return record.traverse.next_sequence_number();
}

absl::StatusOr<uint64_t> ScanAdmission::Acknowledge(const v1::StreamedScanHeader& header, const std::string& scan_id) {
  if (absl::Status stored = environment_.scans.store->GetScan(scan_id).status(); !stored.ok()) return stored;
  std::set<uint64_t> early = early_;
  uint64_t next = 0;
  const absl::Status added = journal_->Change(
      [&](TraverseRecord& record) {
        next = NextAfter(header.sequence_number(), record.traverse.next_sequence_number(), early);
        record.traverse.set_next_sequence_number(next);
        return environment_.store->AddScan(record,
                                           {header, scan_id, wire::NanosecondsOf(std::chrono::system_clock::now())});
      },
      TraverseNotFound(name_));
  if (!added.ok()) return added;
  early_ = std::move(early);
  return next;
}

}  // namespace curvereg::server
