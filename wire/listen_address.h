// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// HOST:PORT: where a server listens, and where a client finds it.
#ifndef CURVEREG_WIRE_LISTEN_ADDRESS_H_
#define CURVEREG_WIRE_LISTEN_ADDRESS_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace curvereg::wire {

struct ListenAddress {
  std::string host;  // without brackets
  uint16_t port = 0;
  bool is_loopback = false;  // 127.0.0.0/8, ::1 or localhost
};

// "127.0.0.1:50051", "[::1]:0", "0.0.0.0:50051", "localhost:50051". INVALID_ARGUMENT: no host, no port, or a port that
// is not a number from 0 to 65535.
absl::StatusOr<ListenAddress> ParseListenAddress(std::string_view text);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_LISTEN_ADDRESS_H_
