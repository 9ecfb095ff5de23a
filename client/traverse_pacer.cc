// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/traverse_pacer.h"

#include <algorithm>

namespace curvereg::internal {
namespace {

using std::chrono::milliseconds;

constexpr double kLeastWindow = 4 * 1024;
constexpr double kFirstWindow = 16 * 1024;
constexpr double kGreatestWindow = 16 << 20;
constexpr uint64_t kLeastChunk = 1024;
constexpr uint64_t kChunksPerWindow = 4;
// A chunk counts for nothing until its last byte is there, so on slow links it is short.
constexpr double kChunkSeconds = 0.04;
// Links that answer sooner lose too little by a cut to be paced.
constexpr milliseconds kQuick(50);
// Mean delay in a queue: below the first nothing waits; above the last the pace is more than the link carries.
constexpr milliseconds kNoQueue(20);
constexpr milliseconds kShortQueue(60);
constexpr milliseconds kLongQueue(120);
constexpr double kFastGrowth = 1.5;
constexpr double kGrowth = 1.0 / 8.0;
constexpr double kSlowGrowth = 1.0 / 32.0;
constexpr double kReduction = 0.9;
// The least delay seen is forgotten after one to two of these: links change.
constexpr std::chrono::seconds kStretch(60);
// A timer that rings late may catch up by so much.
constexpr milliseconds kCatchUp(50);

}  // namespace

TraversePacer::TraversePacer(uint64_t max_chunk_bytes)
    : max_chunk_bytes_(std::max<uint64_t>(max_chunk_bytes, 1)), window_(kFirstWindow) {
  least_delays_.fill(Duration::max());
}

void TraversePacer::Restart() {
  under_way_.clear();
  sent_ = acknowledged_ = round_end_ = 0;
  round_delay_ = Duration(0);
  round_count_ = 0;
  was_full_ = false;
  next_send_ = {};
}

TraversePacer::Duration TraversePacer::BaseDelay() const { return std::min(least_delays_[0], least_delays_[1]); }

bool TraversePacer::IsPaced() const {
  const Duration base = BaseDelay();
  return base != Duration::max() && base > kQuick;
}

uint64_t TraversePacer::ChunkBytes() const {
  const uint64_t quarter = Window() / kChunksPerWindow;
  if (!IsPaced()) return std::clamp<uint64_t>(quarter, 1, max_chunk_bytes_);
  const double per_second = window_ / std::chrono::duration<double>(BaseDelay()).count();
  const auto wanted = std::max(kLeastChunk, static_cast<uint64_t>(per_second * kChunkSeconds));
  return std::clamp<uint64_t>(std::min(wanted, quarter), 1, max_chunk_bytes_);
}

uint64_t TraversePacer::NextChunkBytes(TimePoint now) const {
  return window_is_full() || now < next_send_ ? 0 : ChunkBytes();
}

void TraversePacer::Sent(uint64_t num_bytes, TimePoint now) {
  sent_ += num_bytes;
  if (under_way_.empty()) round_end_ = sent_;
  under_way_.push_back({sent_, now, acknowledged_});
  was_full_ = was_full_ || window_is_full();
  if (!IsPaced()) return;
  const std::chrono::duration<double> time =
      std::chrono::duration<double>(BaseDelay()) * (static_cast<double>(num_bytes) / window_);
  next_send_ = std::max(next_send_, now - kCatchUp) + std::chrono::duration_cast<Duration>(time);
}

void TraversePacer::Acknowledged(uint64_t num_bytes, TimePoint now) {
  acknowledged_ = std::max(acknowledged_, std::min(num_bytes, sent_));
  while (!under_way_.empty() && under_way_.front().end <= acknowledged_) {
    const Chunk chunk = under_way_.front();
    under_way_.pop_front();
    NoteDelay(now - chunk.sent_at, now);
    if (starting_ && now - chunk.sent_at > BaseDelay() + 2 * kLongQueue) LeaveStart(chunk, now);
  }
  if (acknowledged_ >= round_end_ && round_count_ > 0) EndRound();
}

void TraversePacer::NoteDelay(Duration delay, TimePoint now) {
  if (now >= stretch_end_) {
    least_delays_[1] = least_delays_[0];
    least_delays_[0] = delay;
    stretch_end_ = now + kStretch;
  }
  least_delays_[0] = std::min(least_delays_[0], delay);
  round_delay_ += delay;
  ++round_count_;
}

// By what arrived while this chunk was under way.
void TraversePacer::LeaveStart(const Chunk& chunk, TimePoint now) {
  starting_ = false;
  const double share = std::chrono::duration<double>(BaseDelay()) / std::chrono::duration<double>(now - chunk.sent_at);
  const double arrived = static_cast<double>(acknowledged_ - chunk.acknowledged_then) * share;
  window_ = std::clamp(kReduction * arrived, kLeastWindow, window_);
}

void TraversePacer::EndRound() {
  const Duration waited = round_delay_ / round_count_ - BaseDelay();
  if (waited > kLongQueue) {
    window_ *= kReduction;
    starting_ = false;
  } else if (was_full_ && waited <= kShortQueue) {
    const double step = waited <= kNoQueue ? kGrowth : kSlowGrowth;
    window_ *= starting_ ? kFastGrowth : 1.0 + step;
  }
  window_ = std::clamp(window_, kLeastWindow, kGreatestWindow);
  round_delay_ = Duration(0);
  round_count_ = 0;
  was_full_ = window_is_full();
  round_end_ = under_way_.empty() ? sent_ : under_way_.back().end;
}

}  // namespace curvereg::internal
