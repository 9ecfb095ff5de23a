// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// How much of an upload may be under way. What is not acknowledged when the link is cut is sent again, so on a link
// that is slow to acknowledge it is kept to a share of the payload; where acknowledgements come at once it grows until
// the link is full.
#ifndef CURVEREG_CLIENT_UPLOAD_WINDOW_H_
#define CURVEREG_CLIENT_UPLOAD_WINDOW_H_

#include <chrono>
#include <cstdint>
#include <deque>

namespace curvereg::internal {

class UploadWindow {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  struct Options {
    uint64_t share_base_bytes = 0;  // the payload; after a cut what the last stream brought over, if that is less
    double max_resend_share = 0.02;
    uint64_t max_chunk_bytes = 512 * 1024;
  };
  explicit UploadWindow(const Options& options);

  // Size of a chunk at `offset` of a payload of `payload_bytes`, `committed` of them acknowledged; 0: wait.
  uint64_t NextChunkBytes(uint64_t offset, uint64_t committed, uint64_t payload_bytes) const;

  // A chunk that ends at `end_offset` went out; all before `committed` was acknowledged.
  void Sent(uint64_t end_offset, TimePoint now);
  void Acknowledged(uint64_t committed, TimePoint now);

  uint64_t bytes() const { return bytes_; }
  // Acknowledgements have come at once for some time.
  bool IsWideOpen() const;

 private:
  struct Chunk {
    uint64_t end_offset;
    TimePoint sent_at;
  };
  void EndRound();

  uint64_t least_bytes_;
  uint64_t max_chunk_bytes_;
  uint64_t bytes_;
  std::deque<Chunk> under_way_;
  uint64_t round_end_ = 0;  // acknowledged up to here, the round is over
  std::chrono::nanoseconds slowest_{0};
};

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_UPLOAD_WINDOW_H_
