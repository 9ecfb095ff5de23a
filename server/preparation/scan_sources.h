// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What it takes to load scans and to prepare them for registration.
#ifndef CURVEREG_SERVER_PREPARATION_SCAN_SOURCES_H_
#define CURVEREG_SERVER_PREPARATION_SCAN_SOURCES_H_

#include <algorithm>

#include "server/operations/metrics.h"
#include "server/preparation/prepared_scan_cache.h"
#include "server/scheduling/memory_budget.h"
#include "server/settings/server_config.h"
#include "server/store/scan_store.h"
#include "wire/cloud_header.h"

namespace curvereg::server {

// Everything it points to outlives those who use it.
struct ScanSources {
  LimitsConfig limits;  // resolved: no zeros that mean "as the machine has"
  MemoryBudget* memory = nullptr;
  PreparedScanCache* cache = nullptr;
  ScanStore* store = nullptr;  // null: no scan is stored, all come inline
  Metrics* metrics = nullptr;
};

// For decoding a scan. An inline payload has passed the limit on messages already; the limit here is also on the block
// that a payload decompresses to.
inline wire::PointLimits PointLimitsOf(const LimitsConfig& limits) {
  return {.max_points = limits.max_scan_points,
          .max_payload_bytes = std::max(limits.max_scan_bytes, limits.max_message_bytes)};
}

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_PREPARATION_SCAN_SOURCES_H_
