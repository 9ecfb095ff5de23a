// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a map is made of, and what it takes to make it.
#ifndef CURVEREG_SERVER_MAPS_MAP_SOURCE_H_
#define CURVEREG_SERVER_MAPS_MAP_SOURCE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/rigid_transform.h"
#include "server/scheduling/memory_budget.h"
#include "server/settings/server_config.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

// The scans of one segment of a traverse and their poses, as many of the one as of the other, at one version of the
// trajectory.
struct MapSource {
  uint64_t version = 0;
  std::vector<std::string> scan_ids;
  std::vector<RigidTransform> T_segment_scan;
};

// Everything it points to outlives those who use it.
struct MapEnvironment {
  LimitsConfig limits;  // resolved
  ScanStore* store = nullptr;
  MemoryBudget* memory = nullptr;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_MAPS_MAP_SOURCE_H_
