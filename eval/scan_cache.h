// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Scans of a data set, read when first asked for and kept while they fit: consecutive pairs share scans.
#ifndef CURVEREG_EVAL_SCAN_CACHE_H_
#define CURVEREG_EVAL_SCAN_CACHE_H_

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/scan/scan.h"

namespace curvereg {

using ScanLoader = std::function<absl::StatusOr<Scan>(const std::string& path)>;

// Not safe for several threads at once.
class ScanCache {
 public:
  // Keeps up to `max_points` points (12 bytes each), and always the scan asked for last.
  explicit ScanCache(ScanLoader load, int64_t max_points = 32'000'000);

  // The scan stays valid for as long as the caller holds it. The loader's error, which names the file, otherwise.
  absl::StatusOr<std::shared_ptr<const Scan>> Get(const std::string& path);

 private:
  struct Entry {
    std::string path;
    std::shared_ptr<const Scan> scan;
  };
  void Shrink();

  ScanLoader load_;
  int64_t max_points_;
  int64_t num_points_ = 0;
  std::list<Entry> entries_;  // most recently used first
};

}  // namespace curvereg

#endif  // CURVEREG_EVAL_SCAN_CACHE_H_
