// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_engine.h"

#include <algorithm>
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

// Digests of different algorithms do not tell: then the stored scan decides.
bool MayBeSame(const v1::StreamedScanHeader& a, const v1::StreamedScanHeader& b) {
  return a.payload_bytes() == b.payload_bytes() && CanonicalHeader(a.header()) == CanonicalHeader(b.header()) &&
         (a.payload_digest().algorithm() != b.payload_digest().algorithm() ||
          wire::SameDigest(a.payload_digest(), b.payload_digest()));
}

absl::Status DiffersError(uint64_t sequence_number) {
  return wire::MakeError(v1::ERROR_REASON_SEQUENCE_DIFFERS,
                         absl::StrCat("scan ", sequence_number, " is there already, and is another one"));
}

}  // namespace

TraverseEngine::TraverseEngine(const Environment& environment, const TraverseRecord& record, std::set<uint64_t> early,
                               const TrackingOptions& options, std::shared_ptr<TraverseWatchers> watchers)
    : environment_(environment),
      client_(absl::StrCat("traverse/", record.traverse.name())),
      name_(record.traverse.name()),
      num_threads_(options.registration.num_threads),
      watchers_(std::move(watchers)),
      record_(record),
      early_(std::move(early)),
      work_(environment.work, options) {}

TraverseRecord TraverseEngine::record() const {
  const std::lock_guard lock(mutex_);
  return record_;
}

absl::StatusOr<StreamTicket> TraverseEngine::BeginStream(const std::stop_source& owner) {
  std::stop_source former(std::nostopstate);
  StreamTicket ticket;
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return TraverseNotFound(name_);
    TraverseRecord record = record_;
    if (absl::Status status = environment_.work.store->Fence(record); !status.ok()) return status;
    record_ = record;
    former = std::exchange(owner_, owner);
    ticket = {*wire::TraverseIdOf(name_, "name"), record_.fencing_number, record_.traverse.next_sequence_number(),
              record_.traverse.settings().reorder_window()};
  }
  former.request_stop();  // runs the other stream's reaction, so without a lock of ours
  return ticket;
}

absl::Status TraverseEngine::Check(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                   bool* known) const {
  if (closed_) return TraverseNotFound(name_);
  if (ticket.fencing_number != record_.fencing_number) {
    return wire::MakeError(v1::ERROR_REASON_WRITER_REPLACED, "another stream took the traverse over");
  }
  const uint64_t sequence_number = header.sequence_number();
  const uint64_t next = record_.traverse.next_sequence_number();
  *known = sequence_number < next || early_.contains(sequence_number);
  if (*known) {
    const absl::StatusOr<std::optional<AcknowledgedScan>> scan =
        environment_.work.store->FindScan(record_.number, sequence_number);
    if (!scan.ok()) return scan.status();
    if (scan->has_value() && MayBeSame((*scan)->header, header)) return absl::OkStatus();
    return DiffersError(sequence_number);
  }
  if (sequence_number > next + record_.traverse.settings().reorder_window()) {
    return wire::MakeError(v1::ERROR_REASON_SEQUENCE_OUT_OF_RANGE, "the sequence number leaves a gap",
                           {{"next_sequence_number", absl::StrCat(next)}});
  }
  if (sequence_number >= static_cast<uint64_t>(environment_.limits.max_scans_per_traverse)) {
    return wire::MakeError(v1::ERROR_REASON_TRAVERSE_FULL, "the traverse has as many scans as it may",
                           {{"limit", absl::StrCat(environment_.limits.max_scans_per_traverse)}});
  }
  return wire::WithinField("header", PriorOf(header).status());
}

absl::Status TraverseEngine::CheckScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) {
  const std::lock_guard lock(mutex_);
  return Check(ticket, header, known);
}

void TraverseEngine::CountAcknowledged(uint64_t sequence_number, TraverseRecord& record,
                                       std::set<uint64_t>& early) const {
  early.insert(sequence_number);
  uint64_t next = record.traverse.next_sequence_number();
  while (early.erase(next) > 0) ++next;
  record.traverse.set_next_sequence_number(next);
}

absl::StatusOr<uint64_t> TraverseEngine::AddScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                                 const std::string& scan_id) {
  std::stop_source background(std::nostopstate);
  uint64_t next = 0;
  {
    const std::lock_guard lock(mutex_);
    bool known = false;
    if (absl::Status status = Check(ticket, header, &known); !status.ok()) return status;
    if (known) {
      const absl::StatusOr<std::optional<AcknowledgedScan>> scan =
          environment_.work.store->FindScan(record_.number, header.sequence_number());
      if (!scan.ok()) return scan.status();
      if (!scan->has_value() || (*scan)->scan_id != scan_id) return DiffersError(header.sequence_number());
      return record_.traverse.next_sequence_number();
    }
    TraverseRecord record = record_;
    std::set<uint64_t> early = early_;
    CountAcknowledged(header.sequence_number(), record, early);
    const absl::Status status = environment_.work.store->AddScan(
        record, {header, scan_id, wire::NanosecondsOf(std::chrono::system_clock::now())});
    if (!status.ok()) return status;
    record_ = std::move(record);
    early_ = std::move(early);
    next = record_.traverse.next_sequence_number();
    is_waiting_ = false;
    background = background_;
  }
  background.request_stop();
  Kick();
  return next;
}

}  // namespace curvereg::server
