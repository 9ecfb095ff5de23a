// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Prepared scans by name, least recently used first out, so that registering against a known scan costs one scan's
// work.
#ifndef CURVEREG_SERVER_PREPARATION_PREPARED_SCAN_CACHE_H_
#define CURVEREG_SERVER_PREPARATION_PREPARED_SCAN_CACHE_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/methods/prepared_scan.h"

namespace curvereg::server {

class PreparedScanCache {
 public:
  using Loader = std::function<absl::StatusOr<std::unique_ptr<const PreparedScan>>(const Stop&)>;

  struct Statistics {
    uint64_t num_hits = 0;
    uint64_t num_misses = 0;
    uint64_t num_evictions = 0;
    uint64_t num_entries = 0;
    uint64_t bytes = 0;  // PreparedScan::MemoryBytes of all entries, as last seen
  };

  explicit PreparedScanCache(uint64_t max_bytes);
  ~PreparedScanCache();

  // The prepared scan of this name, loaded by `load` unless it is there. Callers that ask for the same scan at once
  // share one loading; when the one that loads is stopped, another takes over. A scan larger than the whole budget is
  // given out but not kept. Errors: those of `load`; CANCELLED / DEADLINE_EXCEEDED by `stop` while waiting.
  absl::StatusOr<std::shared_ptr<const PreparedScan>> Get(const std::string& name, const Loader& load,
                                                          const Stop& stop);
  // The prepared scan of this name if it is there, else null. Counts as a hit, or not at all.
  std::shared_ptr<const PreparedScan> Find(const std::string& name);

  // Forgets it; those who hold it keep it.
  void Erase(const std::string& name);

  // What is kept grows as a scan is used (views are computed on first use): call after use.
  void UpdateSize(const std::string& name);

  Statistics GetStatistics() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_PREPARATION_PREPARED_SCAN_CACHE_H_
