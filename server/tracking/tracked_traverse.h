// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// START HERE: one traverse of a server, as streams and calls see it. What was acknowledged is on disk; all that happens
// is an event with a number. Safe to use from several threads; nothing here waits for a registration.
#ifndef CURVEREG_SERVER_TRACKING_TRACKED_TRAVERSE_H_
#define CURVEREG_SERVER_TRACKING_TRACKED_TRAVERSE_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/tracking/traverse_types.h"

namespace curvereg::server {

// After the traverse was deleted: TRAVERSE_NOT_FOUND from what changes something.
class TrackedTraverse {
 public:
  virtual ~TrackedTraverse() = default;

  virtual v1::Traverse Description() const = 0;

  // Fences off the stream before; `owner` is requested to stop when the next one fences off this one.
  virtual absl::StatusOr<StreamTicket> BeginStream(const std::stop_source& owner) = 0;
  // Whether that sequence number may be sent now: OK (also for one that is there with the same payload, which `known`
  // then tells), SEQUENCE_OUT_OF_RANGE (beyond the window), SEQUENCE_DIFFERS (there, another payload),
  // WRITER_REPLACED, TRAVERSE_FULL, INVALID_FIELD (the prior).
  virtual absl::Status CheckScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) = 0;
  // The payload is a stored scan: makes it part of the traverse, durably, and queues its registration; the same again
  // changes nothing. Errors as CheckScan, SCAN_NOT_FOUND, STORAGE_FAULT, STORAGE_FULL. Returns the least number not yet
  // acknowledged.
  virtual absl::StatusOr<uint64_t> AddScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                           const std::string& scan_id) = 0;

  // Events from `first_event` on, as many as there are up to `max_events`. OFFSET_OUT_OF_RANGE: beyond the next one.
  virtual absl::StatusOr<std::vector<v1::WatchTraverseResponse>> Events(uint64_t first_event, int max_events) = 0;
  // Results (events of that kind) of sequence numbers from `first_sequence_number` on, in order, up to `max_results`.
  virtual absl::StatusOr<std::vector<v1::ScanResult>> Results(uint64_t first_sequence_number, int max_results) = 0;
  // Calls `wake` (quick, must not call back into here) after every new event and at deletion, until the subscription is
  // destroyed.
  virtual std::unique_ptr<Subscription> Subscribe(std::function<void()> wake) = 0;

  // One page of the poses. INVALID_FIELD: "page_size" or "page_token".
  virtual absl::StatusOr<v1::GetTrajectoryResponse> Trajectory(int page_size, const std::string& page_token) = 0;
  // Of the newest version of the trajectory. INVALID_FIELD "segment": there is none of that number.
  virtual absl::StatusOr<SegmentScans> ScansOfSegment(uint32_t segment) = 0;

  // Waits its turn in the worker pool; `done` is called once: on a worker's thread, at once on refusal, or when the
  // traverse is closed or deleted. `client`: whose turn it takes.
  virtual void Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client, const Stop& stop,
                        OptimizeDone done) = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRACKED_TRAVERSE_H_
