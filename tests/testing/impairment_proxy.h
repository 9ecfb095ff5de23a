// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A bad link on loopback: a TCP relay in user space that delays, throttles, cuts, stalls and damages what passes.
#ifndef CURVEREG_TESTS_TESTING_IMPAIRMENT_PROXY_H_
#define CURVEREG_TESTS_TESTING_IMPAIRMENT_PROXY_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace curvereg::testing {

struct LinkOptions {
  std::chrono::milliseconds one_way_delay{0};  // of each byte, and of a new connection's first byte two more
  double bytes_per_second = 0;                 // each way, shared by all connections; 0: unbounded
  std::chrono::milliseconds cut_every{0};      // 0: never by itself
  std::chrono::milliseconds outage{0};         // after each of these cuts
};

enum class Direction { kToServer, kToClient };

struct LinkStatistics {
  uint64_t bytes_to_server = 0;  // read from clients
  uint64_t bytes_to_client = 0;
  int num_connections = 0;  // accepted and relayed
  int num_cuts = 0;
};

class ImpairmentProxy {
 public:
  // Relays from a free port of 127.0.0.1 to `server_port` there. UNAVAILABLE: no port.
  static absl::StatusOr<std::unique_ptr<ImpairmentProxy>> Start(int server_port, const LinkOptions& options = {});
  virtual ~ImpairmentProxy() = default;  // ends all connections

  virtual int port() const = 0;
  std::string target() const { return "127.0.0.1:" + std::to_string(port()); }

  // Every connection ends with RST at both ends, bytes on their way are lost; new ones get the same for `outage`.
  virtual void Cut(std::chrono::milliseconds outage = std::chrono::milliseconds(0)) = 0;
  // Nothing passes and nobody connects until Resume; nothing is lost.
  virtual void Stall() = 0;
  virtual void Resume() = 0;
  // The connections of now pass nothing ever again, without an end that anybody could notice; new ones work.
  virtual void Abandon() = 0;
  // Flips the lowest bit of the byte at this place of all that is relayed that way.
  virtual void CorruptByte(Direction direction, uint64_t offset) = 0;

  virtual LinkStatistics statistics() const = 0;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_IMPAIRMENT_PROXY_H_
