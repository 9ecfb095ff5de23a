// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A TraverseService in memory that keeps to the contract, registers nothing and writes down all that happens; it can
// end streams at chosen moments. What it keeps outlives the server, as a disk would.
#ifndef CURVEREG_TESTS_CLIENT_FAKE_TRAVERSE_SERVER_H_
#define CURVEREG_TESTS_CLIENT_FAKE_TRAVERSE_SERVER_H_

#include <grpcpp/server.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "curvereg/v1/traverse_service.pb.h"

namespace curvereg::testing {

// Guarded by `mutex` while a server runs.
struct TraverseMemory {
  std::mutex mutex;
  std::vector<v1::StreamedScanHeader> scans;  // complete, by sequence number
  std::string partial;                        // of the next one
  std::vector<v1::ScanResult> results;
  std::vector<v1::WatchTraverseResponse> events;
  std::string map;  // bytes of the points
  uint64_t map_version = 1;
  uint64_t fencing_number = 0;
  int num_streams = 0;
  uint64_t bytes_received = 0;  // of chunks, new or not

  // The streams end with UNAVAILABLE after so many messages of the client's, or of the server's own; 0: never.
  int cut_after_received = 0;
  int cut_after_sent = 0;
  // Asked before `start` is answered; an error ends the stream.
  std::function<grpc::Status(int num_streams)> on_start;
};

class FakeTraverseServer {
 public:
  explicit FakeTraverseServer(TraverseMemory& memory, int port = 0);
  ~FakeTraverseServer();
  int port() const { return port_; }
  std::string target() const { return "127.0.0.1:" + std::to_string(port_); }

 private:
  class Service;
  std::unique_ptr<Service> service_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

// A result as it might be; with a pose.
v1::ScanResult PlausibleResult(uint64_t sequence_number);

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_CLIENT_FAKE_TRAVERSE_SERVER_H_
