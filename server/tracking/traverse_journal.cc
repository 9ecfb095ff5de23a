// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_journal.h"

namespace curvereg::server {

TraverseRecord TraverseJournal::record() const {
  const std::lock_guard lock(mutex_);
  return record_;
}

absl::Status TraverseJournal::Change(const std::function<absl::Status(TraverseRecord& record)>& change,
                                     const absl::Status& error_when_closed) {
  const std::lock_guard lock(mutex_);
  if (is_closed_) return error_when_closed;
  TraverseRecord record = record_;
  absl::Status changed = change(record);
  if (changed.ok()) record_ = std::move(record);
  return changed;
}

void TraverseJournal::Close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
}

bool TraverseJournal::is_closed() const {
  const std::lock_guard lock(mutex_);
  return is_closed_;
}

}  // namespace curvereg::server
