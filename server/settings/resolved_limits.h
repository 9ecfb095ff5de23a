// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Limits that follow the machine, or the container when that has less.
#ifndef CURVEREG_SERVER_SETTINGS_RESOLVED_LIMITS_H_
#define CURVEREG_SERVER_SETTINGS_RESOLVED_LIMITS_H_

#include <cstdint>
#include <string>

#include "server/settings/server_config.h"

namespace curvereg::server {

struct MachineResources {
  int num_processors = 1;     // those this process may run on, at most the cgroup's quota (rounded up); at least 1
  uint64_t memory_bytes = 0;  // physical, at most the cgroup's limit; 0: unknown
};

// Looks at the processors and at files below `root` ("" but for tests): /proc/meminfo, /proc/self/cgroup and the
// cgroup v1 or v2 files it leads to.
MachineResources ReadMachineResources(const std::string& root = "");

// `limits` without the zeros that mean "as the machine has".
LimitsConfig ResolveLimits(LimitsConfig limits, const MachineResources& machine);
LimitsConfig ResolveLimits(const LimitsConfig& limits);  // of this machine

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SETTINGS_RESOLVED_LIMITS_H_
