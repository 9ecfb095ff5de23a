// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The parts of the impairment proxy: one direction of the link, one direction of a connection on it.
#ifndef CURVEREG_TESTS_TESTING_RELAYED_FLOW_H_
#define CURVEREG_TESTS_TESTING_RELAYED_FLOW_H_

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

namespace curvereg::testing {

using LinkClock = std::chrono::steady_clock;

// What all connections share in one direction.
struct LinkLane {
  std::chrono::nanoseconds delay{0};
  double bytes_per_second = 0;  // 0: unbounded
  LinkClock::time_point free_at{};
  uint64_t num_bytes = 0;
  std::optional<uint64_t> corrupt_at;

  // Most bytes that a flow holds: what is on its way, and a tenth of a second in the router's queue.
  uint64_t Capacity() const;
  // Bytes to take at once: a few milliseconds' worth.
  uint64_t Quantum() const;
  // When bytes that come now arrive on the other side. Counts and, where asked to, damages them.
  LinkClock::time_point Pass(std::string& bytes, LinkClock::time_point now);
};

// Bytes from one socket to another. Not to be used after Failed().
class RelayedFlow {
 public:
  RelayedFlow(int from, int to, LinkClock::time_point open_at) : from_(from), to_(to), open_at_(open_at) {}

  void Step(LinkLane& lane, LinkClock::time_point now);
  bool failed() const { return failed_; }
  bool done() const { return ended_ && queue_.empty(); }  // the end was passed on

  // The sockets to wait for, -1 where there is none, and the time when there is something to do in any case.
  int ReadFd(const LinkLane& lane, LinkClock::time_point now) const;
  int WriteFd(LinkClock::time_point now) const;
  LinkClock::time_point NextTime(const LinkLane& lane, LinkClock::time_point now) const;

 private:
  struct Segment {
    LinkClock::time_point due;
    std::string bytes;
    size_t num_sent = 0;
  };
  bool Readable(const LinkLane& lane, LinkClock::time_point now) const;
  void Read(LinkLane& lane, LinkClock::time_point now);
  void Write(LinkClock::time_point now);

  int from_;
  int to_;
  LinkClock::time_point open_at_;
  std::deque<Segment> queue_;
  uint64_t num_queued_ = 0;
  bool ended_ = false;
  bool failed_ = false;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_RELAYED_FLOW_H_
