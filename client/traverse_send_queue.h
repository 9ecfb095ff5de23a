// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a streamer keeps from stream to stream: the scans that are not acknowledged, and what is to be told.
#ifndef CURVEREG_CLIENT_TRAVERSE_SEND_QUEUE_H_
#define CURVEREG_CLIENT_TRAVERSE_SEND_QUEUE_H_

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "client/traverse_conversion.h"
#include "client/traverse_pacer.h"
#include "client/traverses.h"

namespace curvereg::internal {

struct WaitingScan {
  EncodedScan scan;
  uint64_t sent_end = 0;   // greatest offset ever sent
  uint64_t committed = 0;  // acknowledged
  uint64_t begins_at = 0;  // in the bytes of the stream under way, when its header was sent there
  uint64_t sequence_number() const { return scan.header.sequence_number(); }
  uint64_t size() const { return scan.payload.size(); }
};

// All but the constants is guarded by `mutex`; methods expect it to be held.
struct TraverseSendQueue {
  explicit TraverseSendQueue(const StreamOptions& options)
      : last_result(options.last_result), pacer(options.chunk_bytes) {}

  std::mutex mutex;
  std::condition_variable changed;

  std::deque<WaitingScan> waiting;  // in order of sequence numbers, without gaps
  uint64_t waiting_bytes = 0;
  uint64_t end = 0;          // one beyond the last scan given
  bool closed = false;       // no more will be given
  bool greeted = false;      // a server told what it has
  uint64_t next_wanted = 0;  // by the server
  std::optional<uint64_t> last_result;
  TraversePacer pacer;
  StreamProgress progress;
  std::optional<absl::Status> ended;

  // To be told to the caller.
  std::deque<curvereg::ScanResult> results;
  std::deque<std::pair<uint64_t, std::string>> acknowledged;
  bool has_notifications = false;
  bool has_progress = false;  // more is safe or answered than ever before

  void Push(EncodedScan scan);
  // The scan of that number; null where it is not here.
  WaitingScan* Find(uint64_t sequence_number);
  // The scans before `sequence_number` are safe; `name`: of the last of them, where known.
  void DropBefore(uint64_t sequence_number, const std::string& name);
  // All that was given is acknowledged and answered, and no more will come.
  bool IsDone() const;
};

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_TRAVERSE_SEND_QUEUE_H_
