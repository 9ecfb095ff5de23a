// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The pacer on a simulated wire: exact, and in no time.
#include "client/traverse_pacer.h"

#include <algorithm>
#include <cstdio>
#include <deque>

#include <gtest/gtest.h>

namespace curvereg::internal {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using TimePoint = TraversePacer::TimePoint;

struct Wire {
  nanoseconds one_way{0};
  double bytes_per_second = 0.0;
};

struct Outcome {
  double seconds_on_the_way = 0.0;  // mean of all bytes, from Sent to the other end
  double bytes_per_second = 0.0;    // that arrived
  double most_seconds = 0.0;
};

// A sender that always has more, on a wire that takes one byte after the other; time in steps of a millisecond.
class Simulation {
 public:
  explicit Simulation(const Wire& wire) : wire_(wire) {}

  Outcome Run(TraversePacer& pacer, milliseconds time) {
    Outcome outcome;
    uint64_t arrived = 0;
    double byte_seconds = 0.0;
    for (const TimePoint end = now_ + time; now_ < end; now_ += milliseconds(1)) {
      while (!under_way_.empty() && under_way_.front().acknowledged_at <= now_) {
        const Chunk& chunk = under_way_.front();
        pacer.Acknowledged(chunk.end, now_);
        const double seconds = duration<double>(chunk.acknowledged_at - wire_.one_way - chunk.sent_at).count();
        byte_seconds += seconds * static_cast<double>(chunk.size);
        outcome.most_seconds = std::max(outcome.most_seconds, seconds);
        arrived += chunk.size;
        under_way_.pop_front();
      }
      for (uint64_t size = 0; (size = pacer.NextChunkBytes(now_)) > 0;) Send(pacer, size);
    }
    outcome.seconds_on_the_way = byte_seconds / static_cast<double>(std::max<uint64_t>(arrived, 1));
    outcome.bytes_per_second = static_cast<double>(arrived) / duration<double>(time).count();
    return outcome;
  }
  void Cut(TraversePacer& pacer) {
    pacer.Restart();
    under_way_.clear();
    sent_ = 0;
  }
  void SetWire(const Wire& wire) { wire_ = wire; }

 private:
  struct Chunk {
    uint64_t end, size;
    TimePoint sent_at, acknowledged_at;
  };
  void Send(TraversePacer& pacer, uint64_t size) {
    pacer.Sent(size, now_);
    sent_ += size;
    free_at_ = std::max(free_at_, now_) + std::chrono::duration_cast<nanoseconds>(
                                              duration<double>(static_cast<double>(size) / wire_.bytes_per_second));
    under_way_.push_back({sent_, size, now_, free_at_ + 2 * wire_.one_way});
  }

  Wire wire_;
  TimePoint now_{std::chrono::hours(1)};
  TimePoint free_at_{};
  uint64_t sent_ = 0;
  std::deque<Chunk> under_way_;
};

constexpr Wire kLunarLink{milliseconds(1300), 32e3};

TEST(TraversePacerTest, FillsALongWireWithoutAQueue) {
  TraversePacer pacer(512 * 1024);
  Simulation simulation(kLunarLink);
  const Outcome start = simulation.Run(pacer, milliseconds(60'000));
  const Outcome later = simulation.Run(pacer, milliseconds(600'000));
  std::printf("first minute: %.0f bytes/s, %.3f s on the way, %.3f at most; then %.0f bytes/s, %.3f s, %.3f\n",
              start.bytes_per_second, start.seconds_on_the_way, start.most_seconds, later.bytes_per_second,
              later.seconds_on_the_way, later.most_seconds);
  EXPECT_GT(start.bytes_per_second, 0.7 * 32e3);
  EXPECT_LT(start.seconds_on_the_way, 1.6);
  EXPECT_GT(later.bytes_per_second, 0.85 * 32e3);
  EXPECT_LT(later.seconds_on_the_way, 1.40);  // 1.3 s is the wire
  EXPECT_LT(later.most_seconds, 1.6);
}

TEST(TraversePacerTest, RemembersTheWireAfterACut) {
  TraversePacer pacer(512 * 1024);
  Simulation simulation(kLunarLink);
  simulation.Run(pacer, milliseconds(120'000));
  simulation.Cut(pacer);
  const Outcome after = simulation.Run(pacer, milliseconds(22'000));
  EXPECT_GT(after.bytes_per_second, 0.75 * 32e3);  // of 22 s, 2.6 pass until the first acknowledgement
  EXPECT_LT(after.seconds_on_the_way, 1.45);
}

TEST(TraversePacerTest, OpensUpOnAQuickLink) {
  TraversePacer pacer(512 * 1024);
  Simulation simulation({milliseconds(1), 100e6});
  const Outcome outcome = simulation.Run(pacer, milliseconds(5'000));
  EXPECT_GT(outcome.bytes_per_second, 0.9 * 100e6);
  EXPECT_EQ(pacer.NextChunkBytes(TimePoint(std::chrono::hours(2))) % 1024, 0U);
}

TEST(TraversePacerTest, GivesWayWhenTheLinkGetsSlower) {
  TraversePacer pacer(512 * 1024);
  Simulation simulation(kLunarLink);
  simulation.Run(pacer, milliseconds(120'000));
  simulation.SetWire({milliseconds(1300), 8e3});
  simulation.Run(pacer, milliseconds(120'000));
  const Outcome later = simulation.Run(pacer, milliseconds(120'000));
  EXPECT_LT(later.seconds_on_the_way, 1.8);  // a chunk alone takes 0.13 s
  EXPECT_GT(later.bytes_per_second, 0.8 * 8e3);
}

TEST(TraversePacerTest, AlwaysLetsSomethingPassWhenNothingIsUnderWay) {
  TraversePacer pacer(1);
  EXPECT_EQ(pacer.NextChunkBytes(TimePoint()), 1U);
  TraversePacer slow(4096);
  TimePoint now(std::chrono::hours(1));
  for (int i = 0; i < 50; ++i) {  // ever slower
    const uint64_t size = slow.NextChunkBytes(now);
    ASSERT_GT(size, 0U) << i;
    slow.Sent(size, now);
    now += std::chrono::seconds(1 + i);
    slow.Restart();
  }
}

}  // namespace
}  // namespace curvereg::internal
