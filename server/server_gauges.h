// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a scrape of /metrics asks the server's parts for.
#ifndef CURVEREG_SERVER_SERVER_GAUGES_H_
#define CURVEREG_SERVER_SERVER_GAUGES_H_

#include <cstdint>
#include <string>

#include "server/operations/metrics.h"
#include "server/preparation/prepared_scan_cache.h"
#include "server/scheduling/memory_budget.h"
#include "server/scheduling/worker_pool.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

// All outlive the metrics' last scrape.
struct GaugeSources {
  const WorkerPool* pool = nullptr;
  const MemoryBudget* memory = nullptr;
  const PreparedScanCache* cache = nullptr;
};

void AddServerGauges(Metrics& metrics, const GaugeSources& sources);

// `folder`: the store's, whose disk is looked at.
void AddStoreGauges(Metrics& metrics, ScanStore& store, uint64_t max_stored_bytes, const std::string& folder);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SERVER_GAUGES_H_
