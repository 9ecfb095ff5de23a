// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a server counts, for Prometheus. Names and labels are listed in docs/operations.md; a test holds the two equal.
#ifndef CURVEREG_SERVER_OPERATIONS_METRICS_H_
#define CURVEREG_SERVER_OPERATIONS_METRICS_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/methods/registration_result.h"
#include "curvereg/v1/traverse_service.pb.h"

namespace curvereg::server {

class Metrics {
 public:
  Metrics();
  ~Metrics();

  // One call: `method` as "RegisterScans", `service` as "curvereg.v1.RegistrationService".
  void RpcStarted(const std::string& service, const std::string& method);
  void RpcHandled(const std::string& service, const std::string& method, const std::string& code,
                  std::chrono::nanoseconds duration);
  void MessageReceived(const std::string& service, const std::string& method);  // of a stream or a unary call
  void MessageSent(const std::string& service, const std::string& method);

  void Rejected(const std::string& reason);  // for want of room, by ErrorReason
  void QueueWaited(std::chrono::nanoseconds duration);
  void Registered(const RegistrationResult& result);  // what it took, verdict by reason, residual, overlap
  void ScanReceived(uint64_t num_points);
  void UploadResumed();
  void UploadCompleted(uint64_t num_bytes);
  void ChecksumFailed();
  // `latency_s`: from its acknowledgement; `acquisition_s`: since the scan before was taken, 0 where unknown.
  void ScanTracked(v1::PoseOrigin origin, double latency_s, double acquisition_s);
  void SegmentJoined();
  void TraverseOptimized(std::chrono::nanoseconds duration);
  void TraverseEvents(uint64_t num_events);

  // Values asked for at each scrape: called on the operations port's thread.
  void SetGauge(const std::string& name, const std::string& help, std::function<double()> read);
  void SetCounter(const std::string& name, const std::string& help, std::function<double()> read);

  // Prometheus text format 0.0.4.
  std::string Text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_OPERATIONS_METRICS_H_
