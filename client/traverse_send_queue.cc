// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/traverse_send_queue.h"

#include <algorithm>
#include <utility>

namespace curvereg::internal {

void TraverseSendQueue::Push(EncodedScan scan) {
  end = scan.header.sequence_number() + 1;
  waiting_bytes += scan.payload.size();
  waiting.push_back({.scan = std::move(scan)});
  if (greeted) DropBefore(next_wanted, "");
}

WaitingScan* TraverseSendQueue::Find(uint64_t sequence_number) {
  if (waiting.empty() || sequence_number < waiting.front().sequence_number() || sequence_number >= end) return nullptr;
  return &waiting[sequence_number - waiting.front().sequence_number()];
}

void TraverseSendQueue::DropBefore(uint64_t sequence_number, const std::string& name) {
  while (!waiting.empty() && waiting.front().sequence_number() < sequence_number) {
    const WaitingScan& scan = waiting.front();
    waiting_bytes -= scan.size();
    progress.bytes_acknowledged += scan.size() - scan.committed;
    ++progress.num_acknowledged;
    acknowledged.emplace_back(scan.sequence_number(), scan.sequence_number() + 1 == sequence_number ? name : "");
    waiting.pop_front();
    has_notifications = true;
  }
}

bool TraverseSendQueue::IsDone() const {
  if (!closed || !greeted || !waiting.empty()) return false;
  return (last_result ? *last_result + 1 : 0) >= std::max(end, next_wanted);
}

}  // namespace curvereg::internal
