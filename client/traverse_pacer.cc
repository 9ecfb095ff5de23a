// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/traverse_pacer.h"

#include <algorithm>
#include <cmath>

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
// Mean wait in a queue: up to the first nothing waits; above the second the pace is more than the link carries.
constexpr milliseconds kNoQueue(30);
constexpr milliseconds kLongQueue(60);
constexpr double kStartGrowth = 2.0;
constexpr double kGrowth = 1.125;
constexpr double kCarefulGrowth = 1.03125;  // near the window that was too large
constexpr double kNear = 0.15;
constexpr double kReduction = 0.9;
// The least delay seen is forgotten after one to two of these: links change.
constexpr std::chrono::seconds kStretch(60);
// A timer that rings late may catch up by so much.
constexpr milliseconds kCatchUp(50);

}  // namespace

TraversePacer::TraversePacer(uint64_t max_chunk_bytes)
    : max_chunk_bytes_(std::max<uint64_t>(max_chunk_bytes, 1)), window_(kFirstWindow) {
  least_delays_.fill(Duration::max());
  SetWindow(kFirstWindow);
}

void TraversePacer::Restart() {
  under_way_.clear();
  sent_ = acknowledged_ = 0;
  next_send_ = {};
  SetWindow(window_);
}

bool TraversePacer::IsPaced() const { return IsKnown() && BaseDelay() > kQuick; }

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
  under_way_.push_back({sent_, now, acknowledged_, !IsKnown()});
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
    if (!chunk.is_blind) Judge(chunk, now - chunk.sent_at);
  }
  if (acknowledged_ >= round_end_ || under_way_.empty()) EndRound();
}

void TraversePacer::NoteDelay(Duration delay, TimePoint now) {
  if (now >= stretch_end_) {
    least_delays_[1] = least_delays_[0];
    least_delays_[0] = delay;
    stretch_end_ = now + kStretch;
  }
  least_delays_[0] = std::min(least_delays_[0], delay);
}

void TraversePacer::Judge(const Chunk& chunk, Duration delay) {
  if (starting_ && IsPaced() && delay > BaseDelay() + 4 * kLongQueue) {
    // Grown too far. What arrived while this chunk was under way tells what the link carries.
    starting_ = false;
    const auto arrived = static_cast<double>(acknowledged_ - chunk.acknowledged_then);
    const double share = std::chrono::duration<double>(BaseDelay()) / std::chrono::duration<double>(delay);
    SetWindow(std::min(window_, kReduction * arrived * share));
  } else if (chunk.end > judged_from_) {
    round_delay_ += delay;
    ++round_count_;
  }
}

void TraversePacer::EndRound() {
  const Duration waited = round_count_ > 0 ? round_delay_ / round_count_ - BaseDelay() : Duration(0);
  double window = window_;
  if (waited > kLongQueue) {
    starting_ = false;
    top_ = window_;
    const double share =
        std::chrono::duration<double>(BaseDelay()) / std::chrono::duration<double>(BaseDelay() + waited);
    window *= std::min(kReduction, share);
  } else if (was_full_ && waited <= kNoQueue) {
    window *= Growth();
  }
  SetWindow(window);
}

double TraversePacer::Growth() const {
  if (starting_) return kStartGrowth;
  const bool is_near = std::abs(window_ - top_) < kNear * top_;
  return is_near ? kCarefulGrowth : kGrowth;
}

void TraversePacer::SetWindow(double window) {
  window_ = std::clamp(window, kLeastWindow, kGreatestWindow);
  judged_from_ = sent_;
  round_end_ = sent_ + Window() / 2;
  round_delay_ = Duration(0);
  round_count_ = 0;
  was_full_ = window_is_full();
}

}  // namespace curvereg::internal
