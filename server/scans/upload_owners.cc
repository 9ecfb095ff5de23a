// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/upload_owners.h"

#include <utility>

namespace curvereg::server {

absl::Status UploadOwners::TakeOver(const std::string& upload_id, const std::stop_source& owner,
                                    const std::function<absl::Status()>& begin) {
  std::stop_source former(std::nostopstate);
  {
    const std::lock_guard beginning(begin_mutexes_[std::hash<std::string>()(upload_id) % begin_mutexes_.size()]);
    if (absl::Status begun = begin(); !begun.ok()) return begun;
    const std::lock_guard lock(mutex_);
    // A new entry is without a state to stop.
    former = std::exchange(owners_.try_emplace(upload_id, std::nostopstate).first->second, owner);
  }
  // Runs the other stream's stop callback, so no lock may be held.
  former.request_stop();
  return absl::OkStatus();
}

void UploadOwners::Release(const std::string& upload_id, const std::stop_source& owner) {
  const std::lock_guard lock(mutex_);
  const auto found = owners_.find(upload_id);
  if (found != owners_.end() && found->second == owner) owners_.erase(found);
}

}  // namespace curvereg::server
