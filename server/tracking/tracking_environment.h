// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the traverses of a server share.
#ifndef CURVEREG_SERVER_TRACKING_TRACKING_ENVIRONMENT_H_
#define CURVEREG_SERVER_TRACKING_TRACKING_ENVIRONMENT_H_

#include "server/operations/logging.h"
#include "server/preparation/scan_sources.h"
#include "server/scheduling/delayed_calls.h"
#include "server/scheduling/worker_pool.h"
#include "server/tracking/scan_uses.h"
#include "server/tracking/traverse_store.h"

namespace curvereg::server {

// Everything it points to outlives the traverses.
struct TrackingEnvironment {
  ScanSources scans;
  TraverseStore* store = nullptr;
  ScanUses* uses = nullptr;
  WorkerPool* pool = nullptr;
  DelayedCalls* delayed = nullptr;
  Logger* logger = nullptr;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRACKING_ENVIRONMENT_H_
