// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One traverse in memory, whose scans are registered when the test says so.
#ifndef CURVEREG_TESTS_SERVER_TRAVERSES_FAKE_TRAVERSES_H_
#define CURVEREG_TESTS_SERVER_TRAVERSES_FAKE_TRAVERSES_H_

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/traverses/traverses.h"

namespace curvereg::testing {

class FakeTraverses final : public server::Traverses, public server::TrackedTraverse {
 public:
  static constexpr char kName[] = "traverses/t";

  explicit FakeTraverses(bool registers_at_once = true) : registers_at_once_(registers_at_once) {}

  // Gives the scan its result, which is an event as well.
  void Register(uint64_t sequence_number);
  std::string ScanIdOf(uint64_t sequence_number);  // empty: not acknowledged
  int num_added() const;                           // calls of AddScan that changed something
  void set_source_version(uint64_t version);

  void Close() override {}
  absl::StatusOr<v1::Traverse> Create(const v1::CreateTraverseRequest& request) override;
  absl::StatusOr<std::shared_ptr<server::TrackedTraverse>> Find(const std::string& name) override;
  absl::StatusOr<v1::ListTraversesResponse> List(const v1::ListTraversesRequest& request) override;
  absl::Status Delete(const std::string& name) override;
  absl::Status DeleteScan(const std::string& scan_id) override;
  uint64_t num_traverses() override { return 1; }

  // Of the one traverse.
  v1::Traverse Description() const override;
  absl::StatusOr<server::StreamTicket> BeginStream(const std::stop_source& owner) override;
  absl::Status CheckScan(const server::StreamTicket& ticket, const v1::StreamedScanHeader& header,
                         bool* known) override;
  absl::StatusOr<uint64_t> AddScan(const server::StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                   const std::string& scan_id) override;
  absl::StatusOr<std::vector<v1::WatchTraverseResponse>> Events(uint64_t first_event, int max_events) override;
  absl::StatusOr<std::vector<v1::ScanResult>> Results(uint64_t first_sequence_number, int max_results) override;
  std::unique_ptr<server::Subscription> Subscribe(std::function<void()> wake) override;
  absl::StatusOr<v1::GetTrajectoryResponse> Trajectory(int page_size, const std::string& page_token) override;
  absl::StatusOr<server::SegmentScans> ScansOfSegment(uint32_t segment) override;
  void Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client, const Stop& stop,
                server::OptimizeDone done) override;

 private:
  class Listener;

  absl::Status CheckName(const std::string& name) const;  // with the mutex held
  absl::Status Check(const server::StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) const;
  void WakeAll();

  const bool registers_at_once_;
  mutable std::mutex mutex_;
  bool is_deleted_ = false;
  uint64_t fencing_number_ = 0;
  std::stop_source owner_{std::nostopstate};
  std::map<uint64_t, std::pair<v1::StreamedScanHeader, std::string>> scans_;
  std::vector<v1::WatchTraverseResponse> events_;
  uint64_t source_version_ = 1;
  std::mutex listeners_mutex_;  // held while they are called
  std::set<Listener*> listeners_;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_SERVER_TRAVERSES_FAKE_TRAVERSES_H_
