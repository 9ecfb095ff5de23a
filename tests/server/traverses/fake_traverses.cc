// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/server/traverses/fake_traverses.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::testing {

class FakeTraverses::Listener final : public server::Subscription {
 public:
  Listener(FakeTraverses& traverses, std::function<void()> wake) : traverses_(traverses), wake_(std::move(wake)) {
    const std::lock_guard lock(traverses_.listeners_mutex_);
    traverses_.listeners_.insert(this);
  }
  ~Listener() override {
    const std::lock_guard lock(traverses_.listeners_mutex_);
    traverses_.listeners_.erase(this);
  }
  void Wake() const { wake_(); }

 private:
  FakeTraverses& traverses_;
  const std::function<void()> wake_;
};

void FakeTraverses::Register(uint64_t sequence_number) {
  {
    const std::lock_guard lock(mutex_);
    v1::WatchTraverseResponse& event = events_.emplace_back();
    event.set_event(events_.size() - 1);
    event.mutable_result()->set_sequence_number(sequence_number);
  }
  WakeAll();
}

std::string FakeTraverses::ScanIdOf(uint64_t sequence_number) {
  const std::lock_guard lock(mutex_);
  const auto found = scans_.find(sequence_number);
  return found == scans_.end() ? "" : found->second.second;
}

int FakeTraverses::num_added() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(scans_.size());
}

void FakeTraverses::set_source_version(uint64_t version) {
  const std::lock_guard lock(mutex_);
  source_version_ = version;
}

void FakeTraverses::WakeAll() {
  const std::lock_guard lock(listeners_mutex_);
  for (const Listener* listener : listeners_) listener->Wake();
}

absl::Status FakeTraverses::CheckName(const std::string& name) const {
  if (name == kName && !is_deleted_) return absl::OkStatus();
  return wire::MakeError(v1::ERROR_REASON_TRAVERSE_NOT_FOUND, "no such traverse");
}

absl::StatusOr<v1::Traverse> FakeTraverses::Create(const v1::CreateTraverseRequest&) {
  return absl::UnimplementedError("not here");
}

absl::StatusOr<std::shared_ptr<server::TrackedTraverse>> FakeTraverses::Find(const std::string& name) {
  const std::lock_guard lock(mutex_);
  if (const absl::Status status = CheckName(name); !status.ok()) return status;
  return std::shared_ptr<server::TrackedTraverse>(std::shared_ptr<void>(), this);  // owned by the test
}

v1::Traverse FakeTraverses::Description() const {
  v1::Traverse traverse;
  traverse.set_name(kName);
  return traverse;
}

absl::StatusOr<v1::ListTraversesResponse> FakeTraverses::List(const v1::ListTraversesRequest&) {
  return absl::UnimplementedError("not here");
}

absl::StatusOr<v1::GetTrajectoryResponse> FakeTraverses::Trajectory(int, const std::string&) {
  return absl::UnimplementedError("not here");
}

absl::Status FakeTraverses::Delete(const std::string& name) {
  {
    const std::lock_guard lock(mutex_);
    if (absl::Status status = CheckName(name); !status.ok()) return status;
    is_deleted_ = true;
  }
  WakeAll();
  return absl::OkStatus();
}

absl::StatusOr<server::StreamTicket> FakeTraverses::BeginStream(const std::stop_source& owner) {
  std::stop_source former(std::nostopstate);
  server::StreamTicket ticket;
  {
    const std::lock_guard lock(mutex_);
    if (const absl::Status status = CheckName(kName); !status.ok()) return status;
    former = std::exchange(owner_, owner);
    ticket = {.traverse_id = "t", .fencing_number = ++fencing_number_, .next_sequence_number = scans_.size()};
  }
  former.request_stop();
  return ticket;
}

absl::Status FakeTraverses::Check(const server::StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                  bool* known) const {
  if (absl::Status status = CheckName(kName); !status.ok()) return status;
  if (ticket.fencing_number != fencing_number_) {
    return wire::MakeError(v1::ERROR_REASON_WRITER_REPLACED, "another stream");
  }
  const auto found = scans_.find(header.sequence_number());
  *known = found != scans_.end();
  if (*known && !wire::SameDigest(found->second.first.payload_digest(), header.payload_digest())) {
    return wire::MakeError(v1::ERROR_REASON_SEQUENCE_DIFFERS, "another payload");
  }
  if (*known || header.sequence_number() == scans_.size()) return absl::OkStatus();
  return wire::MakeError(v1::ERROR_REASON_SEQUENCE_OUT_OF_RANGE, "a gap",
                         {{"next_sequence_number", absl::StrCat(scans_.size())}});
}

absl::Status FakeTraverses::CheckScan(const server::StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                      bool* known) {
  const std::lock_guard lock(mutex_);
  return Check(ticket, header, known);
}

absl::StatusOr<uint64_t> FakeTraverses::AddScan(const server::StreamTicket& ticket,
                                                const v1::StreamedScanHeader& header, const std::string& scan_id) {
  {
    const std::lock_guard lock(mutex_);
    bool known = false;
    if (const absl::Status status = Check(ticket, header, &known); !status.ok()) return status;
    if (known) return scans_.size();
    scans_[header.sequence_number()] = {header, scan_id};
  }
  if (registers_at_once_) Register(header.sequence_number());
  return header.sequence_number() + 1;
}

absl::StatusOr<std::vector<v1::WatchTraverseResponse>> FakeTraverses::Events(uint64_t first_event, int max_events) {
  const std::lock_guard lock(mutex_);
  if (const absl::Status status = CheckName(kName); !status.ok()) return status;
  if (first_event > events_.size()) return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "beyond the next");
  const uint64_t end = std::min<uint64_t>(events_.size(), first_event + static_cast<uint64_t>(max_events));
  return std::vector(events_.begin() + static_cast<std::ptrdiff_t>(first_event),
                     events_.begin() + static_cast<std::ptrdiff_t>(end));
}

absl::StatusOr<std::vector<v1::ScanResult>> FakeTraverses::Results(uint64_t first_sequence_number, int max_results) {
  const std::lock_guard lock(mutex_);
  if (const absl::Status status = CheckName(kName); !status.ok()) return status;
  std::vector<v1::ScanResult> results;
  for (const v1::WatchTraverseResponse& event : events_) {
    if (event.result().sequence_number() < first_sequence_number) continue;
    if (static_cast<int>(results.size()) == max_results) break;
    results.push_back(event.result());
  }
  return results;
}

std::unique_ptr<server::Subscription> FakeTraverses::Subscribe(std::function<void()> wake) {
  return std::make_unique<Listener>(*this, std::move(wake));
}

void FakeTraverses::Optimize(const v1::OptimizeTraverseRequest&, const std::string&, const Stop&,
                             server::OptimizeDone done) {
  done(absl::UnimplementedError("not here"));
}

absl::StatusOr<server::SegmentScans> FakeTraverses::ScansOfSegment(uint32_t) {
  const std::lock_guard lock(mutex_);
  if (const absl::Status status = CheckName(kName); !status.ok()) return status;
  server::SegmentScans source;
  source.version = source_version_;
  for (const auto& [number, scan] : scans_) {
    source.scan_ids.push_back(scan.second);
    source.T_segment_scan.push_back(RigidTransform::Identity());
  }
  return source;
}

absl::Status FakeTraverses::DeleteScan(const std::string&) { return absl::UnimplementedError("not here"); }

}  // namespace curvereg::testing
