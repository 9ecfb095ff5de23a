// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/scan_cache.h"

#include <algorithm>
#include <utility>

namespace curvereg {
namespace {
int64_t NumPoints(const Scan& scan) { return static_cast<int64_t>(scan.points.size()); }
}  // namespace

ScanCache::ScanCache(ScanLoader load, int64_t max_points) : load_(std::move(load)), max_points_(max_points) {}

absl::StatusOr<std::shared_ptr<const Scan>> ScanCache::Get(const std::string& path) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.path == path; });
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
    return entries_.front().scan;
  }
  absl::StatusOr<Scan> scan = load_(path);
  if (!scan.ok()) return scan.status();
  entries_.push_front({path, std::make_shared<const Scan>(*std::move(scan))});
  num_points_ += NumPoints(*entries_.front().scan);
  Shrink();
  return entries_.front().scan;
}

void ScanCache::Shrink() {
  while (num_points_ > max_points_ && entries_.size() > 1) {
    num_points_ -= NumPoints(*entries_.back().scan);
    entries_.pop_back();
  }
}

}  // namespace curvereg
