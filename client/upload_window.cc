// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/upload_window.h"

#include <algorithm>

namespace curvereg::internal {
namespace {

constexpr uint64_t kLeastWindow = 64 * 1024;
constexpr uint64_t kGreatestWindow = uint64_t{16} << 20;
constexpr uint64_t kChunksPerWindow = 4;
// Quicker than this: a cut costs less than a blink, so the window may grow. Slower than the other: back to the share.
constexpr std::chrono::milliseconds kQuick(50);
constexpr std::chrono::milliseconds kSlow(250);

}  // namespace

UploadWindow::UploadWindow(const Options& options)
    : least_bytes_(std::max(kLeastWindow, static_cast<uint64_t>(options.max_resend_share *
                                                                static_cast<double>(options.share_base_bytes)))),
      max_chunk_bytes_(std::max<uint64_t>(options.max_chunk_bytes, 1)),
      bytes_(least_bytes_) {}

uint64_t UploadWindow::NextChunkBytes(uint64_t offset, uint64_t committed, uint64_t payload_bytes) const {
  const uint64_t chunk = std::min({bytes_ / kChunksPerWindow, max_chunk_bytes_, payload_bytes - offset});
  return offset - committed + chunk <= bytes_ ? chunk : 0;
}

bool UploadWindow::IsWideOpen() const { return bytes_ >= kGreatestWindow; }

void UploadWindow::Sent(uint64_t end_offset, TimePoint now) {
  if (under_way_.empty()) round_end_ = end_offset;
  under_way_.push_back({end_offset, now});
}

void UploadWindow::Acknowledged(uint64_t committed, TimePoint now) {
  while (!under_way_.empty() && under_way_.front().end_offset <= committed) {
    slowest_ = std::max<std::chrono::nanoseconds>(slowest_, now - under_way_.front().sent_at);
    under_way_.pop_front();
  }
  if (committed >= round_end_) EndRound();
}

void UploadWindow::EndRound() {
  if (slowest_ <= kQuick) bytes_ = std::max(bytes_, std::min(2 * bytes_, kGreatestWindow));
  if (slowest_ > kSlow) bytes_ = least_bytes_;
  slowest_ = std::chrono::nanoseconds(0);
  if (!under_way_.empty()) round_end_ = under_way_.back().end_offset;
}

}  // namespace curvereg::internal
