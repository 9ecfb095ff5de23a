// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// How fast a stream of scans goes out. What is on its way when a link is cut is sent again, and no pace changes the
// share that a wire's length costs; what a queue before the wire holds would come on top. So bytes go out evenly, about
// as fast as acknowledgements say that they arrive, and where those take longer than they need to, slower.
//
// The window follows the delay beyond the least one seen, as TCP Vegas does [Brakmo, O'Malley, Peterson: TCP Vegas,
// 1994, section 3.2]; on links that answer at once it grows until nothing waits for it.
#ifndef CURVEREG_CLIENT_TRAVERSE_PACER_H_
#define CURVEREG_CLIENT_TRAVERSE_PACER_H_

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <deque>

namespace curvereg::internal {

class TraversePacer {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::nanoseconds;

  explicit TraversePacer(uint64_t max_chunk_bytes);

  // A new stream: nothing is under way. What is known of the link stays.
  void Restart();

  // Size of the next chunk; 0: not yet.
  uint64_t NextChunkBytes(TimePoint now) const;
  // When time alone is what the next chunk waits for, if it does.
  TimePoint next_send() const { return next_send_; }
  bool window_is_full() const { return sent_ - acknowledged_ + ChunkBytes() > Window(); }

  void Sent(uint64_t num_bytes, TimePoint now);
  // Of all bytes sent since Restart.
  void Acknowledged(uint64_t num_bytes, TimePoint now);

  uint64_t Window() const { return static_cast<uint64_t>(window_); }

 private:
  struct Chunk {
    uint64_t end;
    TimePoint sent_at;
    uint64_t acknowledged_then;
    bool is_blind;  // sent when nothing was known of the link, so in a burst
  };
  uint64_t ChunkBytes() const;
  bool IsKnown() const { return BaseDelay() != Duration::max(); }
  bool IsPaced() const;
  Duration BaseDelay() const { return std::min(least_delays_[0], least_delays_[1]); }
  void NoteDelay(Duration delay, TimePoint now);
  void Judge(const Chunk& chunk, Duration delay);
  void EndRound();
  double Growth() const;
  void SetWindow(double window);

  const uint64_t max_chunk_bytes_;
  double window_;
  double top_ = 0.0;                      // the last window that was too large; 0: none yet
  bool starting_ = true;                  // none ever was: the window grows fast
  std::array<Duration, 2> least_delays_;  // of this stretch of time and the one before
  TimePoint stretch_end_{};

  std::deque<Chunk> under_way_;
  uint64_t sent_ = 0;
  uint64_t acknowledged_ = 0;
  TimePoint next_send_{};
  // A round judges a window by chunks that were sent since it was set: those from here on, ...
  uint64_t judged_from_ = 0;
  uint64_t round_end_ = 0;   // ... up to here
  Duration round_delay_{0};  // sum
  int round_count_ = 0;
  bool was_full_ = false;  // in this round
};

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_TRAVERSE_PACER_H_
